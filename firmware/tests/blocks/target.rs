//! The files of the firmware with compilers for microcontrollers, warnings and sanitizers.
use std::path::Path;
use std::process::Command;

use stochc_firmware::{Image, Sizes, files};
use tempfile::TempDir;

use crate::compiled::tables;
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
    let tables = tables(&std::fs::read_to_string(path).unwrap());
    let image = Image::new(&tables).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files(&image, &tables) {
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
        ("gcc-avr", "avr-", &["-mmcu=atmega328p", "-mcall-prologues"]),
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

/// Rules of MISRA C:2012 that the interpreter does not follow. The guide lists the reasons.
const DEVIATIONS: [&str; 4] = ["2.4", "2.5", "8.7", "15.5"];

#[test]
fn interpreter_follows_misra_except_for_the_listed_rules() {
    let guide = std::fs::read_to_string(format!("{ROOT}/../docs/guides/firmware.md")).unwrap();
    for rule in DEVIATIONS {
        assert!(guide.contains(&format!("\n| {rule} |")), "{rule}");
    }
    let (_, folder) = firmware("five_tower_reconfigured");
    let arguments = [
        "--addon=misra",
        "--enable=style",
        "--std=c99",
        "--quiet",
        "--template={id}",
        "-DSA_PLATE",
        "block.c",
        "plate.c",
        "program.c",
    ];
    let output = Command::new("cppcheck")
        .current_dir(folder.path())
        .args(arguments)
        .output();
    let Ok(output) = output else {
        skipped("cppcheck", "cppcheck");
        return;
    };
    let shown = String::from_utf8_lossy(&output.stderr);
    let rules: Vec<&str> = shown
        .lines()
        .filter_map(|line| line.strip_prefix("misra-c2012-"))
        .collect();
    assert!(output.status.success() && !rules.is_empty(), "{shown}");
    let others: Vec<_> = rules
        .iter()
        .filter(|rule| !DEVIATIONS.contains(rule))
        .collect();
    assert!(others.is_empty(), "{others:?}");
}

#[test]
fn arbitrary_bytes_never_break_a_block_or_the_plate() {
    let program = std::fs::read_to_string(format!("{ROOT}/tests/fuzz/fuzz.sa")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let tables = tables(&program);
    for (name, text) in files(&Image::new(&tables).unwrap(), &tables) {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let harness = std::fs::read(format!("{ROOT}/tests/fuzz/fuzz.c")).unwrap();
    std::fs::write(folder.path().join("fuzz.c"), harness).unwrap();
    for plate in ["-USA_PLATE", "-DSA_PLATE"] {
        let arguments = [
            "-std=c99",
            "-O1",
            "-DSTANDALONE",
            plate,
            "-fsanitize=address,undefined",
            "-fno-sanitize-recover=all",
            "-o",
            "fuzz",
            "fuzz.c",
            "block.c",
            "plate.c",
            "program.c",
        ];
        output(folder.path(), "cc", &arguments).expect("a C compiler");
        let fuzz = folder.path().join("fuzz");
        assert!(output(folder.path(), fuzz.to_str().unwrap(), &[]).is_some());
    }
}

/// Solid cube of 1,000 captures. Most blocks wait for two neighbours.
const CUBE: &str = "
    scene tank from hemisphere { free 2000 uniform }
    assembly cube in tank {
        seed plate 10 x 10 {
            for x in 0..9 { for y in 0..9 { T[x, y, 0] at (x, y) } }
        }
        phase grow {
            for z in 1..10 {
                T[0, 0, z - 1].up -> T[0, 0, z]
                for i in 1..9 {
                    T[i, 0, z - 1].up -> T[i, 0, z] after T[i - 1, 0, z]
                    T[0, i, z - 1].up -> T[0, i, z] after T[0, i - 1, z]
                    for k in 1..9 {
                        T[i, k, z - 1].up -> T[i, k, z] after T[i - 1, k, z], T[i, k - 1, z]
                    }
                }
            }
        }
    }";

#[test]
fn firmware_for_1000_captures_fits_into_32_kib() {
    let bytes = Image::new(&tables(CUBE)).unwrap().bytes.len();
    println!("{bytes} bytes of tables");
    assert!(Sizes::INTERPRETER + bytes <= 32 * 1024, "{bytes}");
}

/// Compiles all blocks as processes, and runs them. Returns the output, and whether they succeeded.
fn processes(option: &str) -> (String, bool) {
    let (_, folder) = firmware("five_tower_reconfigured");
    let sources = ["block.c", "plate.c", "program.c", "posix.c"];
    let options = ["-std=c99", "-DSA_PLATE", option, "-o", "blocks"];
    let arguments = [&options[..], &sources].concat();
    output(folder.path(), "cc", &arguments).expect("a C compiler");
    let mut blocks = Command::new("timeout");
    blocks.arg("120").arg(folder.path().join("blocks")).arg("7");
    let output = blocks.output().unwrap();
    let shown = String::from_utf8_lossy(&output.stdout).into_owned();
    (shown, output.status.success())
}

#[test]
fn blocks_as_processes_build_the_structure() {
    let (shown, is_success) = processes("-O0");
    assert!(is_success, "{shown}");
    assert!(shown.ends_with("all phases are complete\n"), "{shown}");
}

#[test]
fn names_of_all_numbers_are_listed() {
    let (_, folder) = firmware("five_tower_reconfigured");
    let names = std::fs::read_to_string(folder.path().join("names.csv")).unwrap();
    let lines: Vec<&str> = names.lines().collect();
    assert!(lines.contains(&"kind,number,name"), "{names}");
    assert!(lines.contains(&"seed,0,\"A\""), "{names}");
    assert!(lines.contains(&"phase,4,\"corners\""), "{names}");
}

#[test]
fn blocks_as_processes_fail_if_a_block_crashes() {
    // The interpreter reads this number when a frame waits for its acknowledgement.
    let (shown, is_success) = processes("-DSA_RETRY=(__builtin_trap(),8u)");
    assert!(!is_success, "{shown}");
    assert!(!shown.contains("all phases are complete"), "{shown}");
}
