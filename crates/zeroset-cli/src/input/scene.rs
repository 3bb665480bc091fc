//! What was typed about the scene, as the core understands it.

use zeroset::fit::cascade::Scene;
use zeroset::reconstruct::Up;
use zeroset_io::CloudFormat;

use crate::args::{SceneArgs, SceneChoice, UpChoice};
use crate::table::name;

/// Why surveyed inputs are airborne.
pub(crate) const SURVEYED: &str = "every input is las or laz";

/// The scene; `None` if the shape of the cloud is to decide.
pub(crate) fn scene(args: &SceneArgs, formats: &[CloudFormat]) -> Option<Scene> {
    let surveyed = formats.iter().all(|f| matches!(f, CloudFormat::Las | CloudFormat::Laz));
    match args.scene {
        SceneChoice::Auto => surveyed.then_some(Scene::Airborne),
        SceneChoice::Object => Some(Scene::Object),
        SceneChoice::Terrain => Some(Scene::Terrain),
        SceneChoice::Airborne => Some(Scene::Airborne),
        SceneChoice::Free => Some(Scene::Free),
    }
}

pub(crate) fn up(args: &SceneArgs) -> Up {
    up_axis(args.up)
}

pub(crate) fn up_axis(choice: UpChoice) -> Up {
    match choice {
        UpChoice::X => Up::X,
        UpChoice::Y => Up::Y,
        UpChoice::Z => Up::Z,
        UpChoice::MinusX => Up::MinusX,
        UpChoice::MinusY => Up::MinusY,
        UpChoice::MinusZ => Up::MinusZ,
    }
}

/// The name of an axis, as it is typed.
pub(crate) fn up_name(choice: UpChoice) -> &'static str {
    match choice {
        UpChoice::X => "x",
        UpChoice::Y => "y",
        UpChoice::Z => "z",
        UpChoice::MinusX => "-x",
        UpChoice::MinusY => "-y",
        UpChoice::MinusZ => "-z",
    }
}

/// The scene that was chosen, why, and how to choose another.
pub(crate) fn announced(scene: Scene, reason: &str) -> String {
    format!("scene: {}, as {reason}; choose another with --scene object|terrain|airborne|free", name(scene))
}
