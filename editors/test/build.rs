//! Compiles the committed parser, as editors do.
fn main() {
    let folder = "../tree-sitter-stochc/src";
    cc::Build::new()
        .include(folder)
        .file(format!("{folder}/parser.c"))
        .file(format!("{folder}/scanner.c"))
        .warnings(false)
        .opt_level(0)
        .compile("tree-sitter-stochc");
    println!("cargo:rerun-if-changed={folder}");
}
