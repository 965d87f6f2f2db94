use stochc::compiler::diagnostic::Code;

use crate::stochc::{stochc, stochc_with};

#[test]
fn every_code_is_listed_and_has_its_page() {
    let list = stochc("explain");
    assert_eq!((list.status, list.err.as_str()), (0, ""));
    for code in Code::ALL {
        let row = format!("\n  {:20} ", code.name());
        assert!(list.out.contains(&row), "{code}: {}", list.out);
        let page = stochc_with("explain", &[code.name()]);
        assert_eq!((page.status, page.err.as_str()), (0, ""), "{code}");
        assert!(page.out.starts_with("# "), "{}", page.out);
        assert_eq!(
            stochc_with("explain", &[&code.name().to_uppercase()]).out,
            page.out
        );
    }
}

#[test]
fn an_unknown_code_is_a_wrong_command_line() {
    let outcome = stochc("explain cicle");
    assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
    assert!(outcome.err.contains("`cicle`"), "{}", outcome.err);
}
