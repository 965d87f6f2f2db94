use stochc::compiler::diagnostic::Code;

use crate::stochc::{stochc, stochc_with};

#[test]
fn every_code_is_listed_and_has_its_page() {
    let list = stochc("explain");
    assert_eq!((list.status, list.err.as_str()), (0, ""));
    assert_eq!(list.out.lines().count(), Code::ALL.len());
    for line in list.out.lines() {
        let words: Vec<_> = line.split_whitespace().collect();
        assert!(["error", "warning"].contains(&words[1]), "{line}");
        assert!(words.len() > 2, "{line}");
        let page = stochc_with("explain", &[words[0]]);
        assert_eq!((page.status, page.err.as_str()), (0, ""), "{line}");
        assert!(page.out.starts_with("# "), "{}", page.out);
    }
}

#[test]
fn an_unknown_code_is_a_wrong_command_line() {
    let said = stochc("explain cicle");
    assert_eq!((said.status, said.out.as_str()), (2, ""));
    assert!(said.err.contains("`cicle`"), "{}", said.err);
}
