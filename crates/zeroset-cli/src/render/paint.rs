//! Which colours everything gets.

use zeroset::cloud::Attributes;
use zeroset::feature::Features;
use zeroset::monitor::Monitor;
use zeroset_view::color::{
    ColorMap, Ends, Legend, NO_VALUE, PLAIN_POINTS, PLAIN_SURFACE, Scale, class_color, plane_color,
};
use zeroset_view::scene::{
    Layer, Paint, Reference, Scene, curvatures, distances, heights, plane_of_points, variations,
};

use crate::args::{ColorChoice, ColorMapChoice, RenderArgs};
use crate::asprs::class_name;
use crate::content::{Content, Item, off_model, reference};
use crate::error::{CliError, in_words};
use crate::input::up_axis;

/// Values for each position of an item; `None` for items that stay plain.
type Measured = Vec<Option<Vec<Option<f64>>>>;

/// A scale from values to colours, and what they are.
struct Values {
    title: String,
    of_items: Measured,
    ends: Ends,
}

/// Everything in its colours.
pub(super) fn scene(content: Content, args: &RenderArgs, monitor: &dyn Monitor) -> Result<Scene, CliError> {
    monitor.stage("choosing colours");
    let choice = choice(&content, args)?;
    let (paints, legend) = match choice {
        ColorChoice::Auto | ColorChoice::Plain => (content.items.iter().map(plain).collect(), None),
        ColorChoice::Rgb => (rgb(&content, args)?, None),
        ColorChoice::Class => {
            let (paints, legend) = classes(&content, args)?;
            (paints, Some(legend))
        }
        ColorChoice::Plane => (planes(&content)?, None),
        measured => {
            let values = values(measured, &content, args, monitor)?;
            let (paints, legend) = scaled(&content, values, args);
            (paints, Some(legend))
        }
    };
    let Content { items, features, .. } = content;
    let mut layers: Vec<Layer> = features.iter().flat_map(Layer::edges_and_corners).collect();
    let only_features = items.is_empty();
    for (item, paint) in items.into_iter().zip(paints) {
        layers.push(match item {
            Item::Cloud(cloud) => Layer::points(cloud, paint, args.point_size.map(|size| size as f32)),
            Item::Mesh(mesh) => Layer::surface(mesh, paint),
        });
    }
    if only_features {
        layers.extend(features.iter().filter_map(Layer::planes));
    }
    Ok(Scene { layers, legend: legend.filter(|_| !args.no_legend) })
}

/// What colours tell, where that is left open: what the files bring; heights where there are only clouds.
fn choice(content: &Content, args: &RenderArgs) -> Result<ColorChoice, CliError> {
    let asked =
        args.color.unwrap_or(if args.distance_to.is_some() { ColorChoice::Distance } else { ColorChoice::Auto });
    if (asked == ColorChoice::Distance) != args.distance_to.is_some() {
        let what = "--color distance and --distance-to FILE go together; give both, or the latter alone";
        return Err(CliError::Usage(what.into()));
    }
    if asked != ColorChoice::Auto {
        return Ok(asked);
    }
    let has = |test: fn(&Attributes) -> bool| content.items.iter().any(|item| test(item.attributes()));
    let only_clouds = content.items.iter().all(|item| matches!(item, Item::Cloud(_)));
    Ok(if has(|own| own.colors.is_some()) {
        ColorChoice::Rgb
    } else if !only_clouds || content.items.is_empty() {
        ColorChoice::Plain
    } else if has(|own| own.classes.as_ref().is_some_and(|classes| classes.iter().any(|class| *class > 1))) {
        ColorChoice::Class
    } else {
        ColorChoice::Height
    })
}

fn plain(item: &Item) -> Paint {
    Paint::Plain(match item {
        Item::Cloud(_) => PLAIN_POINTS,
        Item::Mesh(_) => PLAIN_SURFACE,
    })
}

/// The files have not what the colours are to tell.
fn missing(what: &'static str, args: &RenderArgs) -> CliError {
    CliError::NothingToColor { inputs: in_words(&args.files), what }
}

fn rgb(content: &Content, args: &RenderArgs) -> Result<Vec<Paint>, CliError> {
    if content.items.iter().all(|item| item.attributes().colors.is_none()) {
        return Err(missing("no colours", args));
    }
    let paint = |item: &Item| item.attributes().colors.clone().map_or_else(|| plain(item), Paint::Each);
    Ok(content.items.iter().map(paint).collect())
}

fn classes(content: &Content, args: &RenderArgs) -> Result<(Vec<Paint>, Legend), CliError> {
    let mut present = [false; 256];
    let paint = |item: &Item| match &item.attributes().classes {
        Some(classes) => {
            classes.iter().for_each(|class| present[usize::from(*class)] = true);
            Paint::Each(classes.iter().map(|class| class_color(*class)).collect())
        }
        None => plain(item),
    };
    let paints = content.items.iter().map(paint).collect();
    let entries: Vec<_> = (0..=u8::MAX)
        .filter(|class| present[usize::from(*class)])
        .map(|class| (class_color(class), format!("{class} {}", class_name(class))))
        .collect();
    if entries.is_empty() {
        return Err(missing("no classes", args));
    }
    Ok((paints, Legend::Names { title: "class".into(), entries }))
}

fn planes(content: &Content) -> Result<Vec<Paint>, CliError> {
    let [features] = &content.features[..] else {
        let what = "--color plane needs the planes of one json file of `zeroset features` among the files";
        return Err(CliError::Usage(what.into()));
    };
    Ok(content.items.iter().map(|item| of_planes(item, features)).collect())
}

fn of_planes(item: &Item, features: &Features) -> Paint {
    let (positions, offset) = item.positions();
    let found = plane_of_points(positions, offset, features);
    Paint::Each(found.into_iter().map(|plane| plane.map_or(NO_VALUE, plane_color)).collect())
}

fn values(
    choice: ColorChoice,
    content: &Content,
    args: &RenderArgs,
    monitor: &dyn Monitor,
) -> Result<Values, CliError> {
    let unit = content.unit.map(|unit| format!(" ({})", unit.symbol())).unwrap_or_default();
    Ok(match (choice, &args.distance_to) {
        (ColorChoice::Residual, _) => {
            let of_items = residuals(content, args, monitor)?;
            Values { title: format!("off the model{unit}"), of_items, ends: Ends::Symmetric }
        }
        (ColorChoice::Curvature, _) => curvature(content, args)?,
        (ColorChoice::Distance, Some(path)) => {
            let to = match reference(path, monitor)? {
                Item::Cloud(cloud) => Reference::points(&cloud),
                Item::Mesh(mesh) => Reference::surface(&mesh),
            };
            monitor.stage("measuring distances");
            let of = |item: &Item| {
                let (positions, offset) = item.positions();
                Some(distances(positions, offset, &to))
            };
            let of_items = content.items.iter().map(of).collect();
            Values { title: format!("distance{unit}"), of_items, ends: Ends::FromZero }
        }
        _ => {
            let up = up_axis(args.up);
            let of = |item: &Item| {
                let (positions, offset) = item.positions();
                Some(heights(positions, offset, up))
            };
            let of_items = content.items.iter().map(of).collect();
            Values { title: format!("height{unit}"), of_items, ends: Ends::Both }
        }
    })
}

/// How far the points lie off the model.
fn residuals(content: &Content, args: &RenderArgs, monitor: &dyn Monitor) -> Result<Measured, CliError> {
    let [(name, solid)] = &content.solids[..] else {
        return Err(CliError::Usage("--color residual needs one model, zset or toml, among the files".into()));
    };
    if !content.items.iter().any(|item| matches!(item, Item::Cloud(_))) {
        return Err(missing("no points whose residuals could be shown", args));
    }
    let of = |item: &Item| match item {
        Item::Cloud(cloud) => off_model(cloud, name, solid, monitor).map(Some),
        Item::Mesh(_) => Ok(None),
    };
    content.items.iter().map(of).collect()
}

/// Mean curvature of the surfaces; surface variation where there are only clouds.
fn curvature(content: &Content, args: &RenderArgs) -> Result<Values, CliError> {
    let has_surface = content.items.iter().any(|item| matches!(item, Item::Mesh(_)));
    if content.items.is_empty() {
        return Err(missing("neither points nor triangles", args));
    }
    let of = |item: &Item| -> Result<Option<Vec<Option<f64>>>, CliError> {
        Ok(match item {
            Item::Mesh(mesh) => {
                let broken = |source| CliError::Mesh { path: args.files.first().cloned().unwrap_or_default(), source };
                Some(curvatures(mesh).map_err(broken)?)
            }
            Item::Cloud(cloud) => (!has_surface).then(|| variations(cloud)),
        })
    };
    let of_items = content.items.iter().map(of).collect::<Result<_, _>>()?;
    Ok(if has_surface {
        let unit = content.unit.map(|unit| format!(" (1/{})", unit.symbol())).unwrap_or_default();
        Values { title: format!("mean curvature{unit}"), of_items, ends: Ends::Symmetric }
    } else {
        Values { title: "surface variation".into(), of_items, ends: Ends::FromZero }
    })
}

/// Colours of values on one scale for all.
fn scaled(content: &Content, values: Values, args: &RenderArgs) -> (Vec<Paint>, Legend) {
    let map = args.color_map.map_or(
        if values.ends == Ends::Symmetric { ColorMap::BlueRed } else { ColorMap::Viridis },
        |choice| match choice {
            ColorMapChoice::Viridis => ColorMap::Viridis,
            ColorMapChoice::Magma => ColorMap::Magma,
            ColorMapChoice::Cividis => ColorMap::Cividis,
            ColorMapChoice::Turbo => ColorMap::Turbo,
            ColorMapChoice::Gray => ColorMap::Gray,
            ColorMapChoice::BlueRed => ColorMap::BlueRed,
        },
    );
    let scale = match args.range {
        Some([low, high]) => Scale { map, low, high },
        None => {
            let all: Vec<Option<f64>> = values.of_items.iter().flatten().flatten().copied().collect();
            Scale::of(&all, map, values.ends)
        }
    };
    let paint = |(item, own): (&Item, &Option<Vec<Option<f64>>>)| match own {
        Some(own) => Paint::Each(own.iter().map(|value| scale.color(*value)).collect()),
        None => plain(item),
    };
    let paints = content.items.iter().zip(&values.of_items).map(paint).collect();
    (paints, Legend::Bar { title: values.title, scale })
}
