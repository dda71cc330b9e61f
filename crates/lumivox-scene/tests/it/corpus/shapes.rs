//! Seeds for OBJ, MTL, PLY and STL.

/// Mixes of corners, polygons of four and of five corners with a dent, groups, colours, lines.
pub const OBJ: &[u8] =
    b"# seed\r\nmtllib none.mtl a b.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\n\
    v 0.5 0.25 0 1 1 1\nv 0 1 \\\n 0 0.5 0.5 0.5\nvt 0 0\nvt 1 0 0\nvt 1 1\nvn 0 0 1\nvn 0 1 1\n\
    o thing\ng left right\ns 1\nusemtl red paint\nf 1/1/1 2/2/1 3/3/2\nf 1//1 2//2 3//1 5//1\n\
    g\ns off\nf 1 2 3 4 5\nf -5/-3 -4/-2 -1/-1\nl 1 2 3\np 1\nvp 0 1\ncurv 0 1 1 2\n\
    s 2\nf 1/1 3/2 5/3\n";

pub const PHONG: &[u8] = b"newmtl a\nKd 0.5 0.25 0.125\nKs 0.5 0.5 0.5\nNs 20\nKe 1 0 0\nd 0.5\nillum 2\n\
    map_Kd -s 2 2 2 -o 0.5 0 0 -clamp on colors.png\nmap_Ks colors.png\nmap_d -imfchan l colors.png\n\
    bump -bm 0.5 colors.png\nmap_Ke colors.png\nnewmtl b\nKd spectral none.rfl\nKa xyz 1 1 1\nTr 0.25\n\
    Ni 1.4\nTf 0.5 0.5 0.5\nmap_Kd missing.png\ndisp colors.png\nnewmtl c\n";

pub const PBR: &[u8] =
    b"newmtl a\nKd 0.5 0.25 0.125\nPr 0.5\nPm 0.25\nPs 0.5\nPc 0.5\nPcr 0.1\naniso 0.5\n\
    map_Pr colors.png\nmap_Pm -imfchan g COLORS.PNG\nnorm colors.png\nnewmtl b\nPm 1\nillum 4\n\
    map_Kd -mm 0 1 -texres 512 -blendu off sub\\Colors.png\n";

pub const ASCII_PLY: &[u8] = b"ply\nformat ascii 1.0\ncomment seed\nelement vertex 4\nproperty float x\n\
    property float y\nproperty double z\nproperty float nx\nproperty float ny\nproperty float nz\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\nproperty float t\n\
    element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n\
    element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n\
    0 0 0 0 0 1 255 0 0 0 0\n1 0 0 0 0 1 0 255 0 1 0\n1 1 0 0 0 1 0 0 255 1 1\n0 1 0 0 0 1 9 9 9 0 1\n\
    3 0 1 2 6 0 0 1 0 1 1\n4 0 1 2 3 0\n0 1\n";

pub const STRIP_PLY: &[u8] =
    b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 2 1 0\n";

pub fn binary_ply(format: &str, word: fn(u32) -> [u8; 4]) -> Vec<u8> {
    let mut ply = format!(
        "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
         property float z\nproperty uchar alpha\nelement face 1\n\
         property list uchar uint vertex_index\nend_header\n"
    )
    .into_bytes();
    for [x, y] in [[0.0_f32, 0.0], [1.0, 0.0], [0.0, 1.0]] {
        ply.extend([x, y, 0.5].map(|v| word(v.to_bits())).concat());
        ply.push(200);
    }
    ply.push(3);
    ply.extend([0, 1, 2].map(word).concat());
    ply
}

pub const ASCII_STL: &[u8] = b"solid one\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n\
       vertex 0 1 0\n  endloop\n endfacet\nendsolid one\nsolid two\nfacet normal 0 0 0\nouter loop\n\
    vertex 0 0 1\nvertex 1 0 1\nvertex 0 1 1e0\nendloop\nendfacet\nendsolid two\n";

pub fn binary_stl() -> Vec<u8> {
    let mut stl = b"solid, but binary".to_vec();
    stl.resize(80, b' ');
    stl.extend(2_u32.to_le_bytes());
    for z in [0.0_f32, 1.0] {
        let corners = [0.0, 0.0, 1.0, 0.0, 0.0, z, 1.0, 0.0, z, 0.0, 1.0, z];
        stl.extend(corners.map(f32::to_le_bytes).concat());
        stl.extend([0x1f, 0x80]);
    }
    stl
}

/// A scene of VXCT with all of its keys, and with things that are ignored.
pub const VXCT: &[u8] = b"scene { name = all
model { name = Box active = true static = false path = models/box.obj primitive = cube
position { x = -0.5f, y = .25f, z = 1e-1 } rotation { x = 90 y = 45.5f z = 0 } scale = 0.5f
scale_x = 1 scale_y = -2f scale_z = 3 shader = COLOR
material { shininess = 32 specular_str = 0.5f diffuse_str = 1 ambient_str = 0.08f
color { r = 1 g = 0.5f b = 0 } } }
model { name = Hidden active = false primitive = cube shader = EMIT material { color { r = 2 } } }
model = { primitive = cube static = true shader = EMITRGBA position { y = 2 } color { } }
model { path = b.obj shader = VOX name = twice name = again } stray
light { position { x = 0 y = 1 z = 0 } color { r = 1 g = 1 b = 1 }
att_constant = 1 att_linear = 0.15f att_quadratic = 0.45f } } scene { } }
";
