//! Reads files that the tests build byte by byte.
use proptest::prelude::*;
use stochc_ir::Cell;

use super::{VoxelScene, magica_voxel};
use crate::target::voxels::UnreadableVoxels;

/// Builder for the chunks of a file.
#[derive(Clone, Default)]
struct Builder(Vec<u8>);

const UPRIGHT: [[u8; 4]; 3] = [[0, 0, 0, 1], [0, 0, 1, 1], [0, 0, 2, 1]];

fn numbers(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|it| it.to_le_bytes()).collect()
}

fn chunk(name: &[u8], content: &[u8], children: &[u8]) -> Vec<u8> {
    let lengths = numbers(&[content.len() as u32, children.len() as u32]);
    [name, &lengths, content, children].concat()
}

fn attributes(pairs: &[(&str, &str)]) -> Vec<u8> {
    let mut out = numbers(&[pairs.len() as u32]);
    for text in pairs.iter().flat_map(|(key, value)| [key, value]) {
        out.extend(numbers(&[text.len() as u32]));
        out.extend(text.as_bytes());
    }
    out
}

impl Builder {
    fn chunk(mut self, name: &[u8], parts: &[Vec<u8>]) -> Builder {
        self.0.extend(chunk(name, &parts.concat(), &[]));
        self
    }

    fn model(self, size: [u32; 3], voxels: &[[u8; 4]]) -> Builder {
        let count = numbers(&[voxels.len() as u32]);
        self.chunk(b"SIZE", &[numbers(&size)])
            .chunk(b"XYZI", &[count, voxels.concat()])
    }

    /// Returns a transform in layer 0.
    fn transform(
        self,
        node: u32,
        child: u32,
        own: &[(&str, &str)],
        frames: &[&[(&str, &str)]],
    ) -> Builder {
        let head = [numbers(&[node]), attributes(own)].concat();
        let rest = numbers(&[child, u32::MAX, 0, frames.len() as u32]);
        let frames = frames.iter().flat_map(|it| attributes(it)).collect();
        self.chunk(b"nTRN", &[head, rest, frames])
    }

    fn group(self, node: u32, own: &[(&str, &str)], children: &[u32]) -> Builder {
        let count = numbers(&[children.len() as u32]);
        let head = [numbers(&[node]), attributes(own)].concat();
        self.chunk(b"nGRP", &[head, count, numbers(children)])
    }

    fn shape(self, node: u32, models: &[u32]) -> Builder {
        let head = [numbers(&[node]), attributes(&[])].concat();
        let mut parts = vec![head, numbers(&[models.len() as u32])];
        for model in models {
            parts.extend([numbers(&[*model]), attributes(&[("_f", "0")])]);
        }
        self.chunk(b"nSHP", &parts)
    }

    fn layer(self, number: u32, own: &[(&str, &str)]) -> Builder {
        let reserved = numbers(&[u32::MAX]);
        self.chunk(b"LAYR", &[numbers(&[number]), attributes(own), reserved])
    }

    fn file(&self) -> Vec<u8> {
        let main = chunk(b"MAIN", &[], &self.0);
        [&b"VOX "[..], &numbers(&[150]), &main].concat()
    }

    fn read(&self) -> Result<VoxelScene, UnreadableVoxels> {
        magica_voxel(&self.file(), None)
    }

    fn cells(&self) -> Vec<Cell> {
        let mut cells = self.read().unwrap().cells;
        cells.sort_unstable();
        cells
    }
}

/// Returns an upright bar of three voxels, in a scene with one transform.
fn bar(own: &[(&str, &str)], frame: &[(&str, &str)]) -> Builder {
    let file = Builder::default().model([1, 1, 3], &UPRIGHT);
    file.transform(0, 1, own, &[frame]).shape(1, &[0])
}

fn cells(places: &[[i32; 3]]) -> Vec<Cell> {
    places.iter().map(|&[x, y, z]| Cell::new(x, y, z)).collect()
}

#[test]
fn a_model_is_put_on_the_plate() {
    let file = Builder::default().model([9, 9, 9], &[[3, 4, 5, 1], [4, 4, 6, 9], [5, 5, 5, 0]]);
    assert_eq!(file.cells(), cells(&[[0, 0, 1], [1, 0, 2]]));
    let file = file.file();
    for length in 0..file.len() {
        assert!(magica_voxel(&file[..length], None).is_err(), "{length}");
    }
}

#[test]
fn rotations_and_translations_are_applied() {
    // Rows x, -z, y: the bar falls over to the south.
    let lying = bar(&[], &[("_r", "40"), ("_t", "7 -2 100")]);
    assert_eq!(lying.cells(), cells(&[[0, 0, 1], [0, 1, 1], [0, 2, 1]]));
    // A corner that is not its own mirror image, turned about the vertical: rows -y, x, z.
    let turn = 0b01_0001;
    let corner = [[0, 0, 0, 1], [1, 0, 0, 1], [1, 1, 0, 1], [1, 1, 1, 1]];
    let file = Builder::default().model([2, 2, 2], &corner);
    let file = file.transform(0, 1, &[], &[&[("_r", &turn.to_string())]]);
    let turned = [[0, 1, 1], [0, 1, 2], [1, 0, 1], [1, 1, 1]];
    assert_eq!(file.shape(1, &[0]).cells(), cells(&turned));
}

/// Builds two shapes with the same model. One of them is in a group that is turned and moved.
#[test]
fn copies_are_placed() {
    let file = Builder::default().model([1, 1, 3], &UPRIGHT);
    let file = file.transform(0, 1, &[], &[&[]]).group(1, &[], &[2, 4]);
    let file = file.transform(2, 3, &[], &[&[("_t", "0 0 1")]]);
    let file = file.shape(3, &[0]);
    // In the group the bar is upright and 5 up. The group lies down to the south, 3 to the east.
    let file = file.transform(4, 5, &[], &[&[("_r", "40"), ("_t", "3 0 0")]]);
    let file = file.group(5, &[], &[6]);
    let file = file.transform(6, 7, &[], &[&[("_t", "0 0 5")]]);
    let expected = [
        [0, 7, 1],
        [0, 7, 2],
        [0, 7, 3],
        [3, 0, 1],
        [3, 1, 1],
        [3, 2, 1],
    ];
    let built = file.shape(7, &[0]).cells();
    assert_eq!(built, cells(&expected));
}

/// Checks that a model of even size turns about a voxel corner. One of odd size turns about the
/// lower corner of its middle voxel.
#[test]
fn models_turn_about_their_middle_rounded_down() {
    // Half a turn about the vertical: rows -x, -y, z.
    let half = ((1 << 2) | (1 << 4) | (1 << 5)).to_string();
    for (size, east) in [(2, 0), (3, 0), (4, 1), (5, 1)] {
        let file = Builder::default()
            .model([size, 1, 1], &[[0, 0, 0, 1]])
            .model([1, 1, 1], &[[0, 0, 0, 1]]);
        let file = file.group(0, &[], &[1, 3]);
        let file = file.transform(1, 2, &[], &[&[("_r", &half)]]);
        let file = file.shape(2, &[0]).transform(3, 4, &[], &[&[]]);
        // The western voxel moves to the east, and from y = 0 to -1.
        let mut expected = cells(&[[0, 1, 1], [east, 0, 1]]);
        expected.sort_unstable();
        assert_eq!(file.shape(4, &[1]).cells(), expected, "{size}");
    }
}

#[test]
fn hidden_models_are_skipped_and_counted() {
    let hidden = [("_hidden", "1")];
    let seen = bar(&[], &[]);
    assert_eq!(seen.read().unwrap().hidden, [0; 0]);
    let by_itself = bar(&hidden, &[]);
    let by_layer = seen.clone().layer(0, &hidden);
    let by_group = Builder::default()
        .model([1, 1, 3], &UPRIGHT)
        .group(0, &hidden, &[1])
        .transform(1, 2, &[], &[&[]])
        .shape(2, &[0]);
    for file in [by_itself, by_layer, by_group] {
        let read = file.read().unwrap();
        assert_eq!((read.cells.len(), &read.hidden[..]), (0, &[0][..]));
    }
    let other_layer = seen.layer(1, &hidden);
    assert_eq!(other_layer.cells().len(), 3);
}

#[test]
fn models_without_voxels_do_not_count() {
    let file = Builder::default().model([1, 1, 3], &UPRIGHT);
    let file = file.model([4, 4, 4], &[]).model([1, 1, 1], &[[0, 0, 0, 0]]);
    assert_eq!(file.cells().len(), 3);
    let empty = Builder::default().model([1, 1, 1], &[]);
    assert_eq!(empty.read().unwrap().cells, []);
    assert_eq!(Builder::default().read(), Err(UnreadableVoxels::NoModel));
}

#[test]
fn one_of_several_models_is_chosen() {
    let file = Builder::default().model([1, 1, 3], &UPRIGHT);
    let file = file
        .model([1, 1, 1], &[[0; 4]])
        .model([1, 1, 1], &[[0, 0, 0, 7]]);
    let error = file.read().unwrap_err().to_string();
    let expected =
        "it holds 2 models and no scene: 0 (3 voxels) and 2 (1 voxel): choose one with `--model`";
    assert_eq!(error, expected);
    let chosen = |file: &Builder, model| magica_voxel(&file.file(), Some(model));
    assert_eq!(chosen(&file, 2).unwrap().cells.len(), 1);
    let error = chosen(&file, 3).unwrap_err();
    assert_eq!(error, UnreadableVoxels::UnknownModel { model: 3, count: 3 });
    // In a scene it is an animation with the orientation of the scene.
    let lying = file.transform(0, 1, &[], &[&[("_r", "40")]]);
    let lying = lying.shape(1, &[0, 2]);
    let error = lying.read().unwrap_err();
    assert!(matches!(error, UnreadableVoxels::Animation { .. }));
    let frame = chosen(&lying, 0).unwrap().cells;
    assert!(frame.iter().all(|cell| cell.z == 1), "{frame:?}");
    let error = chosen(&lying, 1).unwrap_err();
    assert_eq!(error, UnreadableVoxels::UnplacedModel { model: 1 });
}

#[test]
fn a_model_that_cannot_be_placed_is_named() {
    let refused = |file: Builder, part: &str| {
        let error = file.read().unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    };
    let model = || Builder::default().model([1, 1, 3], &UPRIGHT);
    refused(bar(&[], &[("_r", "5")]), "node 0: `5` is not a rotation");
    refused(bar(&[], &[("_t", "1 2")]), "`1 2` is not a translation");
    let frames: [&[(&str, &str)]; 2] = [&[("_f", "0")], &[("_f", "9"), ("_t", "1 0 0")]];
    refused(
        model().transform(0, 1, &[], &frames).shape(1, &[0]),
        "node 0 moves",
    );
    let at_rest: [&[(&str, &str)]; 2] = [&[("_f", "0")], &[("_f", "9")]];
    let file = model().transform(0, 1, &[], &at_rest).shape(1, &[0]);
    assert_eq!(file.cells().len(), 3);
    refused(
        model().transform(0, 4, &[], &[&[]]),
        "node 4, which is missing",
    );
    refused(model().shape(0, &[8]), "model 8, which is missing");
    refused(model().shape(0, &[0]).shape(0, &[0]), "two nodes 0");
    let shared = model().group(0, &[], &[1, 1]).shape(1, &[0]);
    refused(shared, "node 1 has two parents");
    let cycle = model().group(1, &[], &[2]).group(2, &[], &[1]);
    refused(cycle.shape(0, &[0]), "part of a cycle");
    refused(bar(&[], &[("_t", "2000000000 0 0")]), "too far away");
    let unsized_model = Builder::default().chunk(b"XYZI", &[numbers(&[0])]);
    refused(unsized_model, "no size");
}

/// Checks that the number of copies is limited before they are made.
#[test]
fn many_copies_are_refused() {
    let layer: Vec<[u8; 4]> = (0..=255)
        .flat_map(|x| (0..=255).map(move |y| [x, y, 0, 1]))
        .collect();
    let mut file = Builder::default().model([256, 256, 1], &layer);
    file = file.group(0, &[], &(1..=200).collect::<Vec<_>>());
    for node in 1..=200 {
        file = file.shape(node, &[0]);
    }
    assert_eq!(file.read(), Err(UnreadableVoxels::TooLarge));
}

/// Checks that a chain of transforms adds up without overflow.
#[test]
fn long_chains_of_transforms_are_read() {
    let mut file = Builder::default().model([1, 1, 3], &UPRIGHT);
    for node in 0..20_000 {
        file = file.transform(node, node + 1, &[], &[&[("_t", "2147483647 0 0")]]);
    }
    let error = file.shape(20_000, &[0]).read().unwrap_err();
    assert_eq!(error, UnreadableVoxels::TooFar { node: 20_000 });
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_rejected(place in any::<prop::sample::Index>(), byte in any::<u8>(), model in 0..3u32) {
        let mut file = bar(&[("_hidden", "0")], &[("_r", "40"), ("_t", "1 2 3")]).layer(0, &[]).file();
        let place = place.index(file.len());
        file[place] = byte;
        let _ = magica_voxel(&file, None);
        let _ = magica_voxel(&file, Some(model));
    }
}
