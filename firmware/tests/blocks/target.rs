//! The files of the firmware with compilers for microcontrollers, warnings and sanitizers.
use std::path::Path;
use std::process::Command;

use stochc_compiler::check;
use stochc_firmware::{Image, Sizes, files};
use tempfile::TempDir;

use crate::host::ROOT;
use crate::skipped::skipped;

/// Warnings that the C sources must not cause.
const STRICT: [&str; 7] = [
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wconversion",
    "-Wpedantic",
    "-Werror",
    "-Os",
];

/// Returns the image of an example, and a folder with its firmware.
fn firmware(example: &str) -> (Image, TempDir) {
    let path = format!("{ROOT}/../examples/{example}.sa");
    let checked = check(
        &path,
        &mut |path: &str| std::fs::read(path),
        Default::default(),
    );
    let tables = checked.programs[0].tables.as_ref().unwrap();
    let image = Image::new(tables).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files(&image, example, tables.bond.name()) {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    (image, folder)
}

/// Runs a program in a folder. Returns its output, or `None` if the program is not installed.
fn output(folder: &Path, program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program)
        .current_dir(folder)
        .args(arguments)
        .output()
        .ok()?;
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{program} {arguments:?}: {error}");
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[test]
fn compilers_and_cppcheck_have_no_warnings() {
    let (_, folder) = firmware("five_tower_reconfigured");
    for compiler in ["gcc", "clang"] {
        for plate in ["-USA_PLATE", "-DSA_PLATE"] {
            let sources = ["-c", "block.c", "plate.c", "program.c"];
            let arguments = [&STRICT[..], &[plate], &sources].concat();
            if output(folder.path(), compiler, &arguments).is_none() {
                skipped(compiler, compiler);
            }
        }
    }
    let arguments = [
        "--enable=warning,style,performance,portability",
        "--std=c99",
        "--error-exitcode=1",
        "--quiet",
        "block.c",
        "plate.c",
        "program.c",
    ];
    if output(folder.path(), "cppcheck", &arguments).is_none() {
        skipped("cppcheck", "cppcheck");
    }
}

#[test]
fn interpreter_and_block_fit_into_small_processors() {
    let (image, folder) = firmware("five_tower_reconfigured");
    let state = "#include \"block.h\"\nstruct sa_block block;\n";
    std::fs::write(folder.path().join("state.c"), state).unwrap();
    let targets = [
        (
            "gcc-arm-none-eabi",
            "arm-none-eabi-",
            &["-mcpu=cortex-m0", "-mthumb"][..],
        ),
        ("gcc-avr", "avr-", &["-mmcu=atmega328p"]),
    ];
    for (package, prefix, processor) in targets {
        let compiler = format!("{prefix}gcc");
        let common = ["-fno-common", "-c", "block.c", "state.c"];
        let arguments = [&STRICT[..], processor, &common].concat();
        if output(folder.path(), &compiler, &arguments).is_none() {
            skipped(package, &compiler);
            continue;
        }
        let sizes = output(
            folder.path(),
            &format!("{prefix}size"),
            &["block.o", "state.o"],
        );
        let numbers: Vec<Vec<usize>> = sizes
            .unwrap()
            .lines()
            .skip(1)
            .map(|line| {
                let words = line.split_whitespace().take(3);
                words.map(|word| word.parse().unwrap()).collect()
            })
            .collect();
        let (flash, ram) = (numbers[0][0], numbers[1][1] + numbers[1][2]);
        println!("{prefix}gcc: {flash} bytes of flash, {ram} bytes of RAM");
        assert!(flash <= Sizes::INTERPRETER, "{compiler}: {flash}");
        assert_eq!(numbers[0][1..], [0, 0], "the interpreter has no variables");
        assert!(ram <= image.sizes.ram() && ram <= 256, "{compiler}: {ram}");
    }
}

#[test]
fn arbitrary_frames_never_break_a_block() {
    let (_, folder) = firmware("five_tower_reconfigured");
    std::fs::copy(
        format!("{ROOT}/tests/fuzz/fuzz.c"),
        folder.path().join("fuzz.c"),
    )
    .unwrap();
    let arguments = [
        "-std=c99",
        "-O1",
        "-DSTANDALONE",
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover=all",
        "-o",
        "fuzz",
        "fuzz.c",
        "block.c",
        "program.c",
    ];
    output(folder.path(), "cc", &arguments).expect("a C compiler");
    let fuzz = folder.path().join("fuzz");
    assert!(output(folder.path(), fuzz.to_str().unwrap(), &[]).is_some());
}

#[test]
fn blocks_as_processes_build_the_structure() {
    let (_, folder) = firmware("five_tower_reconfigured");
    let sources = ["block.c", "plate.c", "program.c", "posix.c"];
    let arguments = [&["-std=c99", "-DSA_PLATE", "-o", "blocks"][..], &sources].concat();
    output(folder.path(), "cc", &arguments).expect("a C compiler");
    let blocks = folder.path().join("blocks");
    let arguments = ["120", blocks.to_str().unwrap(), "7"];
    let shown = output(folder.path(), "timeout", &arguments).unwrap();
    assert!(shown.ends_with("all phases are complete\n"), "{shown}");
}
