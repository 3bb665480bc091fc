//! Tiles in a folder, step by step, for whoever hands the steps out.
//!
//! Each step goes from files to files and returns at once if its result is there. Only plain values pass through Python.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use zeroset::cloud::Filter;
use zeroset::monitor::Monitor;
use zeroset::reconstruct::ReconstructParams;
use zeroset::tile::{Node, NodeId, TileId, TilePlan};
use zeroset_tiles::{Folder, Sorted, TileEntry, TileFormat, TilesError};

use crate::arrays::dictionary;
use crate::error::Failure;
use crate::options::Options;
use crate::watch::Running;

/// A folder in which tiles are made. Steps run on so many threads.
#[pyclass(frozen, module = "zeroset._core")]
pub(crate) struct TileFolder {
    folder: Folder,
    threads: Option<usize>,
}

impl TileFolder {
    /// Does a step.
    fn run<T, E>(&self, py: Python<'_>, work: impl FnOnce(&Folder, &dyn Monitor) -> Result<T, E> + Send) -> PyResult<T>
    where
        T: Send,
        E: Into<Failure> + Send,
    {
        Running { progress: None, threads: self.threads }.run(py, |monitor| work(&self.folder, monitor))
    }

    /// Does a step that needs the plan.
    fn planned<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&Folder, &Sorted, &TilePlan, &dyn Monitor) -> Result<T, TilesError> + Send,
    ) -> PyResult<T> {
        self.run(py, |folder, monitor| {
            let missing = |name| TilesError::Missing { path: folder.path().join(name) };
            let sorted = folder.sorted()?.ok_or_else(|| missing("sorted.json"))?;
            let plan = folder.plan()?.ok_or_else(|| missing("plan.json"))?;
            work(folder, &sorted, &plan, monitor)
        })
    }
}

#[pymethods]
impl TileFolder {
    #[new]
    #[pyo3(signature = (path: "Any", threads: "int | None"))]
    fn new(path: PathBuf, threads: Option<usize>) -> Self {
        Self { folder: Folder::at(&path), threads }
    }

    /// Makes the folder, or opens one that was begun with the same `run`, which is JSON.
    #[pyo3(signature = (run: "str") -> "None")]
    fn open(&self, run: &str) -> PyResult<()> {
        let run: serde_json::Value = serde_json::from_str(run).map_err(|why| Failure::parameter(why.to_string()))?;
        Folder::open(self.folder.path(), &run).map_err(Failure::from)?;
        Ok(())
    }

    /// Whether an input is sorted into tiles of a side.
    #[pyo3(signature = (input: "int", side: "float") -> "bool")]
    fn is_sorted(&self, input: usize, side: f64) -> PyResult<bool> {
        Ok(self.folder.is_sorted(input, side).map_err(Failure::from)?)
    }

    /// Sorts the points of a file into tiles.
    #[pyo3(signature = (input: "int", path: "Any", side: "float", options: "dict[str, Any]") -> "None")]
    fn sort(
        &self,
        py: Python<'_>,
        input: usize,
        path: PathBuf,
        side: f64,
        options: &Bound<'_, PyDict>,
    ) -> PyResult<()> {
        let options = Options(options);
        let up = options.scene_and_up()?.1;
        let only_classes: Option<Vec<u8>> = options.get("classes")?;
        let noise = || Filter::excluded_by_default(only_classes.as_deref());
        let exclude_classes = options.get::<Option<Vec<u8>>>("exclude")?.unwrap_or_else(noise);
        let bounds = options.get::<Option<[[f64; 3]; 2]>>("bounds")?;
        let bounds = bounds.map(|[low, high]| [0, 1, 2].map(|a| [low[a], high[a]]));
        let filter = Filter { only_classes, exclude_classes, bounds };
        if !(side.is_finite() && side > 0.0) {
            return Err(Failure::parameter(format!("a tile of {side} is not possible; give a positive length")).into());
        }
        self.run(py, |folder, monitor| folder.sort_file(input, &path, &filter, (side, up), monitor))
    }

    /// Puts together what was sorted of so many inputs, and resolves every default. Returns the tiles, each with those around it.
    #[pyo3(signature = (inputs: "int", side: "float", options: "dict[str, Any]") -> "list[tuple[tuple[int, int], list[tuple[int, int]]]]")]
    fn plan(
        &self,
        py: Python<'_>,
        inputs: usize,
        side: f64,
        options: &Bound<'_, PyDict>,
    ) -> PyResult<Vec<(Tile, Vec<Tile>)>> {
        let options = Options(options);
        let params =
            ReconstructParams { simplify: options.simplify()?, attributes: options.attributes()?, ..options.fit()? };
        let plan = self.run(py, |folder, _| {
            let sorted = match folder.sorted()? {
                Some(sorted) => sorted,
                None => folder.finish_sort(inputs, side)?,
            };
            folder.make_plan(&sorted, &params)
        })?;
        let plain = |id: TileId| (id.x, id.y);
        Ok(plan.tiles.iter().map(|&id| (plain(id), plan.neighbors(id).map(plain).collect())).collect())
    }

    /// Thins the points of a tile for coarser levels.
    #[pyo3(signature = (tile: "tuple[int, int]") -> "None")]
    fn thin(&self, py: Python<'_>, tile: Tile) -> PyResult<()> {
        self.planned(py, |folder, sorted, plan, _| folder.thin(sorted, plan, id(tile)))
    }

    /// Fits the coarse levels of the whole. All tiles must be thinned.
    #[pyo3(signature = (options: "dict[str, Any]") -> "None")]
    fn coarse(&self, py: Python<'_>, options: &Bound<'_, PyDict>) -> PyResult<()> {
        let constraints = Options(options).fit()?.constraints;
        self.planned(py, |folder, sorted, plan, monitor| folder.fit_coarse(sorted, plan, &constraints, monitor))
    }

    /// Fits a tile. The coarse levels must be there.
    #[pyo3(signature = (tile: "tuple[int, int]", options: "dict[str, Any]") -> "None")]
    fn fit(&self, py: Python<'_>, tile: Tile, options: &Bound<'_, PyDict>) -> PyResult<()> {
        let constraints = Options(options).fit()?.constraints;
        self.planned(py, |folder, sorted, plan, monitor| {
            let coarse = folder.read_coarse()?;
            folder.fit_tile(sorted, plan, id(tile), (&coarse, &constraints), monitor)
        })
    }

    /// Extracts the surface of a tile. It and those around it must be fitted.
    #[pyo3(signature = (tile: "tuple[int, int]") -> "None")]
    fn mesh(&self, py: Python<'_>, tile: Tile) -> PyResult<()> {
        self.planned(py, |folder, sorted, plan, monitor| folder.mesh_tile(sorted, plan, id(tile), monitor))
    }

    /// Simplifies the surface of a tile, if that is asked for. It and those around it must be extracted.
    #[pyo3(signature = (tile: "tuple[int, int]") -> "None")]
    fn simplify(&self, py: Python<'_>, tile: Tile) -> PyResult<()> {
        self.planned(py, |folder, _, plan, monitor| folder.simplify_tile(plan, id(tile), monitor))
    }

    /// The squares of tiles that are shown as one, level by level: each with its parts.
    #[pyo3(signature = () -> "list[list[tuple[tuple[int, int, int], list[tuple[int, int, int]]]]]")]
    fn levels(&self, py: Python<'_>) -> PyResult<Vec<Vec<SquareOf>>> {
        let levels = self.planned(py, |_, _, plan, _| Ok(plan.levels()))?;
        let plain = |id: NodeId| (id.level, id.x, id.y);
        let node = |node: Node| (plain(node.id), node.children.into_iter().map(plain).collect());
        Ok(levels.into_iter().map(|nodes| nodes.into_iter().map(node).collect()).collect())
    }

    /// Makes and writes a square of tiles, if it has a surface. Its parts must be there: on the first level tiles, and those around them.
    #[pyo3(signature = (square: "tuple[int, int, int]") -> "dict[str, Any] | None")]
    fn level<'py>(&self, py: Python<'py>, square: Square) -> PyResult<Option<Bound<'py, PyDict>>> {
        let (level, x, y) = square;
        let wanted = NodeId { level, x, y };
        let entry = self.planned(py, |folder, sorted, plan, _| {
            let node = plan.levels().into_iter().flatten().find(|node| node.id == wanted);
            node.map_or(Ok(None), |node| folder.make_level(sorted, plan, &node))
        })?;
        entry.map(|entry| dictionary(py, &entry)).transpose()
    }

    /// Writes the surface of a tile, if it has one. It and those around it must be extracted, and it simplified if that is asked for.
    #[pyo3(signature = (tile: "tuple[int, int]", options: "dict[str, Any]") -> "dict[str, Any] | None")]
    fn write<'py>(
        &self,
        py: Python<'py>,
        tile: Tile,
        options: &Bound<'py, PyDict>,
    ) -> PyResult<Option<Bound<'py, PyDict>>> {
        let format = format(options)?;
        let entry = self.planned(py, |folder, sorted, plan, _| folder.write_tile(sorted, plan, id(tile), format))?;
        entry.map(|entry| dictionary(py, &entry)).transpose()
    }

    /// Writes the lists of the tiles that `write` wrote, which are given as JSON. All squares must be there.
    #[pyo3(signature = (entries: "str", options: "dict[str, Any]") -> "None")]
    fn finish(&self, py: Python<'_>, entries: &str, options: &Bound<'_, PyDict>) -> PyResult<()> {
        let format = format(options)?;
        let entries: Vec<TileEntry> =
            serde_json::from_str(entries).map_err(|why| Failure::parameter(why.to_string()))?;
        self.planned(py, |folder, sorted, plan, _| folder.write_lists(sorted, plan, entries, format).map(drop))
    }

    /// Removes what steps handed on.
    #[pyo3(signature = () -> "None")]
    fn remove_work(&self, py: Python<'_>) -> PyResult<()> {
        self.run(py, |folder, _| folder.remove_work())
    }

    /// Removes the folder.
    #[pyo3(signature = () -> "None")]
    fn remove(&self, py: Python<'_>) -> PyResult<()> {
        self.run(py, |folder, _| folder.remove())
    }
}

/// Column and row of a tile.
type Tile = (i32, i32);

/// Level, column and row of a square of tiles.
type Square = (u32, i32, i32);

/// A square and what it is made of.
type SquareOf = (Square, Vec<Square>);

fn id((x, y): Tile) -> TileId {
    TileId { x, y }
}

fn format(options: &Bound<'_, PyDict>) -> PyResult<TileFormat> {
    Options(options)
        .word("tile_format", &[("glb", TileFormat::Glb), ("ply", TileFormat::Ply), ("zset", TileFormat::Zset)])
}
