//! Files of the firmware.
use std::fmt::Write as _;

use stochc_ir::table::Tables;

use crate::image::Image;
use crate::sizes::Sizes;

/// Files that are the same for every program, with their names.
const COMMON: [(&str, &str); 5] = [
    ("block.h", include_str!("../block.h")),
    ("block.c", include_str!("../block.c")),
    ("plate.h", include_str!("../plate.h")),
    ("plate.c", include_str!("../plate.c")),
    ("posix.c", include_str!("../posix/posix.c")),
];

/// Returns the files of the firmware of a program: names and contents.
pub fn files(image: &Image, tables: &Tables) -> Vec<(&'static str, String)> {
    let (assembly, bond) = (&tables.assembly, tables.bond.name());
    let mut files: Vec<_> = COMMON.map(|(name, text)| (name, text.to_owned())).into();
    files.push(("program.h", header(image, assembly, bond)));
    files.push(("program.c", constants(image, assembly)));
    files.push(("names.csv", names(tables)));
    files.push(("BUILD.md", page(image, assembly)));
    files
}

/// Text in the first line of every file.
pub const MARK: &str = "stochc firmware";

/// Returns a table of the numbers of roles and phases.
fn names(tables: &Tables) -> String {
    let mut text = format!(
        "# {MARK}: numbers of the program `{}`. Generated.\nkind,number,name\n",
        tables.assembly
    );
    let kinds = tables.roles.iter().map(|role| match role.seed {
        Some(_) => ("seed", &role.name),
        None => ("block", &role.name),
    });
    let phases = tables.phases.iter().map(|phase| ("phase", &phase.name));
    for (number, (kind, name)) in (0..).zip(kinds).chain((0..).zip(phases)) {
        // Names such as `T[1, 2]` contain commas, and no name contains a quotation mark.
        let _ = writeln!(text, "{kind},{number},\"{name}\"");
    }
    text
}

/// Returns the page on building.
fn page(image: &Image, assembly: &str) -> String {
    let values = [
        ("@ASSEMBLY@", assembly.to_owned()),
        ("@PROGRAM@", image.bytes.len().to_string()),
        ("@INTERPRETER@", Sizes::INTERPRETER.to_string()),
        ("@RAM@", image.sizes.ram().to_string()),
        ("@IDENTITY@", format!("0x{:04x}", image.identity())),
    ];
    filled(include_str!("../templates/BUILD.txt"), &values)
}

/// Returns a template with its placeholders replaced.
fn filled(template: &str, values: &[(&str, String)]) -> String {
    let replace = |text: String, (name, value): &(&str, String)| text.replace(name, value);
    values.iter().fold(template.to_owned(), replace)
}

/// Returns the header with the sizes.
fn header(image: &Image, assembly: &str, bond: &str) -> String {
    let sizes = &image.sizes;
    let plate_waiting = sizes.plate_waiting.max(sizes.waiting);
    let values = [
        ("@ASSEMBLY@", assembly.to_owned()),
        ("@BOND@", bond.to_owned()),
        ("@LAW@", bond.to_uppercase()),
        ("@SEEN@", sizes.observations.max(1).to_string()),
        ("@RULES@", sizes.rules.max(1).to_string()),
        ("@PLATE_WAITING@", plate_waiting.max(1).to_string()),
        ("@WAITING@", sizes.waiting.max(1).to_string()),
        ("@SEEDS@", sizes.seeds.to_string()),
        ("@LENGTH@", image.bytes.len().to_string()),
    ];
    filled(include_str!("../templates/program.h.txt"), &values)
}

/// Returns the program as a constant.
fn constants(image: &Image, assembly: &str) -> String {
    let mut text = format!(
        "/* stochc firmware: the program `{assembly}`. Generated. */
#include \"program.h\"

const uint8_t sa_program[{}]
#ifdef __AVR__
    PROGMEM
#endif
    = {{
",
        image.bytes.len()
    );
    for line in image.bytes.chunks(16) {
        text.push_str("    ");
        for byte in line {
            let _ = write!(text, "0x{byte:02x},");
        }
        text.push('\n');
    }
    text.push_str("};\n");
    text
}
