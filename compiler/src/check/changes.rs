//! Values that replace parameters of programs and scenes.
use stochc_grammar::Symbols;
use stochc_grammar::tree::{Let, Name};
use stochc_ir::scene::Scene;
use stochc_ir::scene::scalars::{ScalarChange, find};

/// Values that replace parameters of programs and scenes.
#[derive(Clone, Copy, Debug)]
pub struct Changes<'a> {
    /// Name of the assembly to change. `None` changes every assembly, and ignores values whose
    /// parameter an assembly lacks.
    assembly: Option<&'a str>,
    /// New values of the parameters.
    values: &'a [ParameterChange],
}

/// New value of a parameter. The program decides whether its own parameter or one of its scene has
/// the name.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterChange {
    /// Name of the parameter.
    pub name: String,
    /// Value of a parameter of the assembly. `None` if the value is not an integer.
    pub integer: Option<i64>,
    /// Values of all scene parameters with this name that can have the value.
    pub scene: Vec<ScalarChange>,
}

impl<'a> Changes<'a> {
    /// No changes.
    pub const NONE: Changes<'static> = Changes {
        assembly: None,
        values: &[],
    };

    /// Changes every assembly. Ignores values whose parameter an assembly lacks.
    pub fn everywhere(values: &'a [ParameterChange]) -> Changes<'a> {
        Changes {
            assembly: None,
            values,
        }
    }

    /// Changes one assembly, which must have all parameters.
    pub fn in_assembly(assembly: &'a str, values: &'a [ParameterChange]) -> Changes<'a> {
        Changes {
            assembly: Some(assembly),
            values,
        }
    }

    /// Returns the values that replace parameters of an assembly or of its scene.
    pub(super) fn values(self, assembly: Name, symbols: &Symbols) -> &'a [ParameterChange] {
        let is_changed = |changed| changed == symbols.word(assembly.symbol);
        if self.assembly.is_none_or(is_changed) {
            self.values
        } else {
            &[]
        }
    }

    /// Returns the values that replace scene parameters of an assembly with these `parameters`.
    pub(super) fn of_scene(
        self,
        assembly: Name,
        parameters: &[Let],
        scene: &Scene,
        symbols: &Symbols,
    ) -> Vec<ScalarChange> {
        let is_own = |name: &str| {
            let mut parameters = parameters.iter();
            parameters.any(|it| symbols.word(it.name.symbol) == name)
        };
        let values = self.values(assembly, symbols).iter();
        let values = values.filter(|change| !is_own(&change.name));
        let in_scene = values.filter_map(|change| match find(scene, &change.name) {
            Ok(number) => change.scene.iter().find(|it| it.name == number.name()),
            Err(_) if self.assembly.is_none() => None,
            Err(_) => change.scene.first(),
        });
        in_scene.cloned().collect()
    }
}
