"""What panels tell about the last picture of a scene; nothing of it is stored in files."""

from __future__ import annotations

from dataclasses import dataclass

#: Voxels above this share of the picture's height hide details of light that would be seen.
COARSE = 1.0 / 24.0


@dataclass
class Status:
    """Facts about the last picture."""

    adapter: str = ""
    voxels: int = 0
    voxel_m: float = 0.0
    #: The edge of a voxel in the median of what is seen, as a share of the picture's height.
    voxel_share: float = 0.0
    notes: tuple[str, ...] = ()

    @property
    def coarse(self) -> str:
        """The advice when voxels are too coarse for what is seen; empty if they are not."""
        if self.voxel_share <= COARSE:
            return ""
        return (
            f"Voxels of {self.voxel_m:.3g} m are {self.voxel_share:.0%} of the picture's height: "
            "raise the resolution, set a box around what is seen, or use cascades"
        )


_KNOWN: dict[str, Status] = {}


def of(scene_name: str) -> Status:
    """The status of a scene."""
    return _KNOWN.setdefault(scene_name, Status())


def set_of(scene_name: str, status: Status) -> list[str]:
    """Stores a status; the sentences that the scene's last one did not have."""
    known = _KNOWN.get(scene_name, Status())
    _KNOWN[scene_name] = status
    told = [*known.notes, known.coarse]
    return [note for note in (*status.notes, status.coarse) if note and note not in told]


def forget() -> None:
    _KNOWN.clear()
