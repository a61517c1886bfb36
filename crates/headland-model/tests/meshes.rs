//! Surfaces of triangles: what is refused, and with which words.
#![cfg(feature = "mesh")]

use std::path::PathBuf;

use headland_model::Scene;

fn message(folder: &std::path::Path, section: &str, surface: &str) -> String {
    let text = format!(
        "[world]\ngravity = [0, 0, -9.81]\n\
         [[body]]\nname = \"ball\"\nmass = 1\nshape = \"sphere\"\nsize = 0.1\n\
         [[surface]]\nname = \"ground\"\nshape = \"mesh\"\n{surface}\
         [[{section}]]\nname = \"c\"\nbody = \"ball\"\non = \"ground\"\nradius = 0.1\n\
         [tables]\nhills = {{ x = [0, 1, 2, 3, 4, 5], y = [0, 1, 2, 3, 4, 5], z = [[0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], \
         [0, 0, 1, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]] }}\n"
    );
    let name = folder.join("scene.toml");
    let scene = Scene::parse(name.to_str().expect("a name"), &text).unwrap_or_else(|e| panic!("{e}"));
    match scene.build() {
        Ok(_) => "built".into(),
        Err(error) => error.to_string(),
    }
}

fn folder() -> PathBuf {
    let folder = std::env::temp_dir().join(format!("headland-meshes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("a file");
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    write("closed.obj", &format!("{corners}f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"));
    write("open.obj", &format!("{corners}f 1 3 2\nf 1 2 4\nf 2 3 4\n"));
    write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n");
    write("turned.obj", &format!("{corners}f 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"));
    write("notes.txt", "no mesh\n");
    folder
}

#[test]
fn what_is_wrong_with_triangles_is_told() {
    let folder = folder();
    let hard = "needs a smooth surface, and this one has 4 triangles, whose normals jump; give a `[[contact]]` with `stiffness`";
    let cases = [
        ("contact", "file = \"closed.obj\"\n", &*format!("hard contact {hard}")),
        ("rolling", "file = \"closed.obj\"\n", &format!("rolling without slipping {hard}")),
        ("contact", "file = \"open.obj\"\n", "is open: 3 edge(s) have one triangle only"),
        ("contact", "file = \"open.obj\"\n", "`open = true` allows it"),
        ("contact", "file = \"open.obj\"\nopen = true\n", "this one has 3 triangles"),
        ("contact", "file = \"flat.obj\"\n", "triangle 0 of the mesh `ground` has no area"),
        ("contact", "file = \"turned.obj\"\n", "turn opposite ways"),
        ("contact", "file = \"none.stl\"\n", "none.stl` (names count from the scene's folder)"),
        ("contact", "file = \"notes.txt\"\n", "is neither a Wavefront OBJ file, `.obj`, nor an STL file"),
        ("contact", "", "a mesh is given by one of `file`, `radius` with `density`, and `table`"),
        ("contact", "radius = 1\n", "this surface needs `density`"),
        ("contact", "radius = 1\ndensity = 2.5\n", "`density` is 2.5; a whole number from 1 to 1000"),
        ("contact", "radius = 1\ndensity = 4\ninside = true\n", "this one has 320 triangles"),
        ("contact", "table = \"hills\"\n", "this one has 50 triangles"),
        ("contact", "table = \"hill\"\n", "`table` names a table of two variables"),
        ("contact", "file = \"closed.obj\"\ndensity = 2\n", "`density` means nothing here"),
        ("contact", "file = \"closed.obj\"\nheight = \"x\"\n", "`height` means nothing here: the shape is \"mesh\""),
    ];
    for (section, surface, wanted) in cases {
        let found = message(&folder, section, surface);
        assert!(found.contains(wanted), "{surface}wanted: {wanted}\nfound: {found}");
    }
    std::fs::remove_dir_all(folder).expect("removed");
}
