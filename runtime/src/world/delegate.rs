//! Non-generic worlds over generic steppers. Their physics is compiled once, in this crate, not in
//! every crate that uses it.

/// Implements the traits of a world for the type `$world` by forwarding each method to its stepper.
/// `$by` is a macro: `$by!(&self.0, stepper => ...)` gives access to the stepper, and `$by!(new
/// precision, ...)` creates one.
macro_rules! delegate {
    ($world:ident, $by:ident) => {
        impl SpatialWorld for $world {
            fn with_blocks(
                scene: &Scene,
                plate: &Plate,
                settings: &Settings,
                seed: u64,
                run: u64,
                blocks: &[BodyState],
            ) -> Result<$world, SceneError> {
                Ok($world($by!(
                    new settings.precision,
                    Stepper::with_blocks(scene, plate, settings, seed, run, blocks)?
                )))
            }

            delegate!(@read $by
                count() -> u32,
                state(id: u32) -> BodyState,
                anchored(id: u32) -> Option<Orientation>,
                active() -> Vec<(BlockFace, u32)>,
                groups() -> Vec<Vec<u32>>,
                free_bonds() -> Vec<FreeBond>,
                in_reach() -> Vec<(BlockFace, u32, u64)>,
                centre(cell: Cell) -> Vector3<f64>
            );
            delegate!(@change $by set_state(id: u32, state: &BodyState) -> ());
        }

        impl State for $world {
            fn save(&self, to: &mut StateWriter<'_>) -> Result<(), StateError> {
                $by!(&self.0, stepper => stepper.save(to))
            }

            fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
                $by!(&mut self.0, stepper => stepper.restore(from))
            }
        }

        impl World for $world {
            delegate!(@read $by
                tick() -> u64,
                entries(block_face: BlockFace) -> u32,
                largest_group() -> u32
            );
            delegate!(@change $by
                place_seeds(cells: &[Cell]) -> (),
                magnetize(block_face: BlockFace) -> (),
                switch_off(block_face: BlockFace) -> (),
                plant(block_face: BlockFace) -> Option<Docking>,
                step(dockings: &mut Vec<Docking>) -> Result<(), Fault>
            );
        }
    };
    (@read $by:ident $($name:ident($($with:ident: $kind:ty),*) -> $out:ty),+) => {
        $(fn $name(&self, $($with: $kind),*) -> $out {
            $by!(&self.0, stepper => stepper.$name($($with),*))
        })+
    };
    (@change $by:ident $($name:ident($($with:ident: $kind:ty),*) -> $out:ty),+) => {
        $(fn $name(&mut self, $($with: $kind),*) -> $out {
            $by!(&mut self.0, stepper => stepper.$name($($with),*))
        })+
    };
}
pub(super) use delegate;
