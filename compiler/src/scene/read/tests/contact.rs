use stochc_ir::scene::{Contact, ContactLaw};

use super::sample::scene;
use crate::diagnostic::Code;

fn contact(fields: &str) -> Option<Contact> {
    let (scene, diagnostics) = scene(&format!("contact {{ {fields} }}"));
    assert_eq!(diagnostics, [], "{fields}");
    scene?.contact
}

fn reported(clause: &str) -> Vec<(Code, String)> {
    let (scene, diagnostics) = scene(clause);
    assert_eq!(scene, None, "{clause}");
    let diagnostics = diagnostics.into_iter();
    diagnostics
        .map(|diagnostic| (diagnostic.code, diagnostic.title))
        .collect()
}

#[test]
fn a_contact_is_rigid_or_compliant() {
    let compliant = |stiffness, damping| {
        Some(Contact {
            law: ContactLaw::Compliant { stiffness, damping },
            friction: 0.2,
        })
    };
    assert_eq!(
        contact("restitution 0.5  friction 0.2"),
        Some(Contact {
            law: ContactLaw::Rigid { restitution: 0.5 },
            friction: 0.2
        })
    );
    assert_eq!(
        contact("stiffness 25 N/m  damping 5 N s/m  friction 0.2"),
        compliant(25.0, 5.0)
    );
    assert_eq!(
        contact("friction 0.2  damping 5000 g/s  stiffness 25 kg/s^2"),
        compliant(25.0, 5.0)
    );
    assert_eq!(
        contact("stiffness 25 N*m^-1  friction 0.2"),
        compliant(25.0, 0.0)
    );
    assert_eq!(
        contact("stiffness 25 N/m  damping 0 kg/s  friction 0.2"),
        compliant(25.0, 0.0)
    );
}

#[test]
fn a_contact_is_not_both() {
    for fields in [
        "restitution 0  stiffness 25 N/m  damping 5 kg/s  friction 0.2",
        "stiffness 25 N/m  restitution 0  friction 0.2",
        "damping 5 kg/s  restitution 0  friction 0.2",
    ] {
        let (scene, diagnostics) = scene(&format!("contact {{ {fields} }}"));
        assert_eq!(scene, None, "{fields}");
        assert_eq!(diagnostics.len(), 1, "{diagnostics:?}");
        assert_eq!(diagnostics[0].code, Code::ConflictingTerms);
        assert!(diagnostics[0].help.is_some());
    }
}

#[test]
fn reports_mistakes_in_a_contact() {
    let missing = |what: &str| vec![(Code::MissingTerm, format!("`contact` {what}"))];
    assert_eq!(reported("contact"), missing("has no fields in braces"));
    assert_eq!(
        reported("contact { friction 0.2 }"),
        missing("lacks `restitution`"),
        "the older kind is the requested one"
    );
    assert_eq!(
        reported("contact { damping 5 kg/s  friction 0.2 }"),
        missing("lacks `stiffness`")
    );
    assert_eq!(
        reported("contact { stiffness 25 N/m }"),
        missing("lacks `friction`")
    );
    let both = [missing("lacks `restitution`"), missing("lacks `friction`")].concat();
    assert_eq!(reported("contact { }"), both);

    let range = |name: &str| {
        (
            Code::WrongValue,
            format!("`contact.{name}` is out of range"),
        )
    };
    assert_eq!(
        reported("contact { stiffness 0 N/m  damping -1 kg/s  friction 0.2 }"),
        [range("stiffness"), range("damping")]
    );
    assert_eq!(
        reported("contact { stiffness 1e60 N/m  damping 1e-60 kg/s  friction 0.2 }"),
        [range("stiffness"), range("damping")]
    );
    let (stiffest, _) = scene("contact { stiffness 1e40 N/m  damping 0 kg/s  friction 0.2 }");
    assert_ne!(stiffest, None);
    let dimension = |text: &str| (Code::WrongDimension, format!("`contact.{text}`"));
    assert_eq!(
        reported("contact { stiffness 25 N  damping 5 N/m  friction 0.2 }"),
        [
            dimension("stiffness` must be a stiffness, such as `25 N/m"),
            dimension("damping` must be a damping, such as `5 N s/m")
        ]
    );
    assert_eq!(
        reported("contact { stiffness 25 N/m  damping  friction 0.2 }"),
        [(
            Code::MissingTerm,
            "`contact.damping` needs a damping, such as `5 N s/m`".to_owned()
        )]
    );
    assert_eq!(
        reported("contact { stifness 25 N/m  stiffness 25 N/m  friction 0.2 }"),
        [(Code::UnknownTerm, "`stifness` is not a field".to_owned())]
    );
    assert_eq!(
        reported("contact { stiffness 25 N/m  stiffness 5 N/m  friction 0.2 }"),
        [(Code::DuplicateTerm, "`stiffness` is given twice".to_owned())]
    );
}

/// Checks that fields without braces are recognized as those of a compliant contact.
#[test]
fn recognizes_fields_without_braces() {
    let (_, diagnostics) = scene("contact stiffness 25 N/m  friction 0.2");
    let [diagnostic] = &diagnostics[..] else {
        panic!("{diagnostics:?}");
    };
    assert_eq!(diagnostic.title, "`contact` has no fields in braces");
    assert!(diagnostic.fix.is_some());
}
