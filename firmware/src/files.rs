//! Files of the firmware.
use std::fmt::Write as _;

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

/// Returns the files of the firmware: names and contents. `assembly` is the name of the program and
/// `bond` the name of its kind of bond.
pub fn files(image: &Image, assembly: &str, bond: &str) -> Vec<(&'static str, String)> {
    let mut files: Vec<_> = COMMON.map(|(name, text)| (name, text.to_owned())).into();
    files.push(("program.h", header(image, assembly, bond)));
    files.push(("program.c", constants(image, assembly)));
    files.push(("BUILD.md", page(image, assembly)));
    files
}

/// Text in the first line of every file.
pub const MARK: &str = "stochc firmware";

/// Returns the page on building.
fn page(image: &Image, assembly: &str) -> String {
    format!(
        "# stochc firmware: `{assembly}`

Write the seven functions at the end of `block.h` in a file `port.c`. In the main loop of a block, call `sa_start` once and
`sa_poll` again and again. The plate calls `sa_plate_start` and `sa_plate_poll`.

```sh
avr-gcc -mmcu=atmega328p -std=c99 -Os -c block.c program.c port.c
arm-none-eabi-gcc -mcpu=cortex-m0 -mthumb -std=c99 -Os -c block.c program.c port.c
```

Try the protocol on a computer, with one process per block:

```sh
cc -std=c99 -DSA_PLATE -o blocks block.c plate.c program.c posix.c && ./blocks
```

For the plate, define `SA_PLATE` for all files, and add `plate.c`.

| memory of a block | bytes |
|---|---|
| flash for the program | {} |
| flash for the interpreter, at most | {} |
| RAM, without the stack | {} |

The blocks ignore messages of other programs. The number of this program is 0x{:04x}.
",
        image.bytes.len(),
        Sizes::INTERPRETER,
        image.sizes.ram(),
        image.identity(),
    )
}

/// Returns the header with the sizes.
fn header(image: &Image, assembly: &str, bond: &str) -> String {
    let sizes = &image.sizes;
    format!(
        "/* stochc firmware: sizes of the program `{assembly}`. Generated. */
#ifndef SA_PROGRAM_H
#define SA_PROGRAM_H

#include <stdint.h>

/* Kind of bond: {bond} */
#define SA_BOND_{}

/* Observations and rules of a block in a phase, at most. */
#define SA_SEEN {}u
#define SA_RULES {}u
/* Notifications that wait at a block, at most. Define SA_PLATE to compile the plate. */
#ifdef SA_PLATE
#define SA_WAITING {}u
#else
#define SA_WAITING {}u
#endif
#define SA_SEEDS {}u

#ifdef __AVR__
#include <avr/pgmspace.h>
extern const uint8_t sa_program[{length}] PROGMEM;
#define SA_READ(at) pgm_read_byte(&sa_program[(at)])
#else
extern const uint8_t sa_program[{length}];
#define SA_READ(at) (sa_program[(at)])
#endif

#endif
",
        bond.to_uppercase(),
        sizes.observations.max(1),
        sizes.rules.max(1),
        sizes.plate_waiting.max(sizes.waiting).max(1),
        sizes.waiting.max(1),
        sizes.seeds,
        length = image.bytes.len(),
    )
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
