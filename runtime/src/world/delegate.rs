//! A world that is one of several steppers, and no generic type: so that its physics is compiled in this crate, and not
//! once more in every crate that uses it.

/// Has `$world` pass on all that is asked of it: `$by!(&self.0, stepper => ...)` asks its stepper, and
/// `$by!(new precision, ...)` holds a new one.
macro_rules! delegate {
    ($world:ident, $by:ident) => {
        impl Arena for $world {
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

            fn count(&self) -> u32 {
                $by!(&self.0, stepper => stepper.count())
            }

            fn state(&self, id: u32) -> BodyState {
                $by!(&self.0, stepper => stepper.state(id))
            }

            fn set_state(&mut self, id: u32, state: &BodyState) {
                $by!(&mut self.0, stepper => stepper.set_state(id, state))
            }

            fn anchored(&self, id: u32) -> Option<Orientation> {
                $by!(&self.0, stepper => stepper.anchored(id))
            }

            fn active(&self) -> Vec<(Site, u32)> {
                $by!(&self.0, stepper => stepper.active())
            }

            fn groups(&self) -> Vec<Vec<u32>> {
                $by!(&self.0, stepper => stepper.groups())
            }

            fn in_reach(&self) -> Vec<(Site, u32, u64)> {
                $by!(&self.0, stepper => stepper.in_reach())
            }

            fn centre(&self, cell: Cell) -> Vector3<f64> {
                $by!(&self.0, stepper => stepper.centre(cell))
            }
        }

        impl World for $world {
            fn tick(&self) -> u64 {
                $by!(&self.0, stepper => stepper.tick())
            }

            fn magnetize(&mut self, site: Site) {
                $by!(&mut self.0, stepper => stepper.magnetize(site))
            }

            fn switch_off(&mut self, site: Site) {
                $by!(&mut self.0, stepper => stepper.switch_off(site))
            }

            fn plant(&mut self, site: Site) -> Option<Docking> {
                $by!(&mut self.0, stepper => stepper.plant(site))
            }

            fn entries(&self, site: Site) -> u32 {
                $by!(&self.0, stepper => stepper.entries(site))
            }

            fn largest_group(&self) -> u32 {
                $by!(&self.0, stepper => stepper.largest_group())
            }

            fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault> {
                $by!(&mut self.0, stepper => stepper.step(dockings))
            }
        }
    };
}
pub(super) use delegate;
