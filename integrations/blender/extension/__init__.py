"""Lumivox for Blender: a render engine beside Cycles and EEVEE."""

from __future__ import annotations


def _modules() -> tuple:
    # Not at the top, so that tests may import modules that do not need Blender.
    from . import engine, operators, panels, properties

    return properties, engine, operators, panels


def register() -> None:
    try:
        import lumivox  # noqa: F401
    except ImportError as error:
        raise ImportError(
            f"{error}. Lumivox for Blender needs the package lumivox, which its archive for this system contains: install "
            "the archive that integrations/blender/pack.py makes"
        ) from error
    for module in _modules():
        module.register()


def unregister() -> None:
    for module in reversed(_modules()):
        module.unregister()
