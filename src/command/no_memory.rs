//! The end of memory.
use std::backtrace::Backtrace;
use std::io::{self, Write as _};

use crate::exit::Exit;

/// What asks us for backtraces of panics, as `RUST_BACKTRACE` asks Rust.
const OURS: &str = "STOCHC_BACKTRACE";

/// Bytes that a library asks for at once which panics when it does not get them.
const OF_A_LIBRARY: usize = 1 << 20;

/// If somebody has asked for backtraces, begins the process anew, where we print those of panics: Rust's own take memory, and where
/// there is none it waits for itself without end. Only the environment decides it, which nobody changes safely in a process.
pub fn print_backtraces_ourselves() {
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt as _;
        const RUSTS: &str = "RUST_BACKTRACE";
        let asked = std::env::var_os(RUSTS).filter(|it| it != "0");
        let (Ok(program), Some(asked)) = (std::env::current_exe(), asked) else {
            return;
        };
        let mut arguments = std::env::args_os();
        let mut command = std::process::Command::new(program);
        if let Some(name) = arguments.next() {
            command.arg0(name);
        }
        command.args(arguments).env(RUSTS, "0").env(OURS, asked);
        // Where it cannot be begun, this one goes on.
        let _ = command.exec();
    }
}

/// Gives the end of memory a status of ours: Rust tells of it on standard error, and aborts.
pub fn exit_without_memory() {
    // zlib-rs panics instead, and nobody is to take that for a mistake of a run.
    let told = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if Vec::<u8>::new().try_reserve_exact(OF_A_LIBRARY).is_err() {
            let _ = io::stderr().write_all(b"error: there is no memory left\n");
            std::process::abort();
        }
        told(panic);
        if std::env::var_os(OURS).is_some() {
            let _ = writeln!(io::stderr(), "{}", Backtrace::force_capture());
        }
    }));
    #[cfg(unix)]
    {
        use std::sync::Arc;
        use std::sync::atomic::AtomicBool;

        use signal_hook::consts::SIGABRT;
        let status = Exit::Usage.status().into();
        let always = Arc::new(AtomicBool::new(true));
        // Where it cannot be had, the process ends by the signal, as it always has.
        let _ = signal_hook::flag::register_conditional_shutdown(SIGABRT, status, always);
    }
}
