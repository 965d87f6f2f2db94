//! Tables of the programs of the tests.
use stochc_compiler::check;
use stochc_ir::table::Tables;

/// Returns the tables of a program.
pub fn tables(text: &str) -> Tables {
    let checked = check(
        "program.sa",
        &mut |_: &str| Ok(text.as_bytes().to_vec()),
        Default::default(),
    );
    let tables = checked.programs[0].tables.clone();
    tables.unwrap_or_else(|| panic!("{:#?}", checked.diagnostics))
}
