//! A page on this machine that shows clouds, meshes and features, and the server behind it.
//!
//! ```text
//! files ── a Loader, from whoever knows formats ── layers ── octrees and plain bytes ── the page, in the browser
//! ```
//!
//! # What is sent
//! The page is at `http://127.0.0.1:PORT/TOKEN/`; all it asks for lies beside it. Numbers are little endian.
//!
//! | path | what |
//! |---|---|
//! | `scene.json` | the layers with their channels, what is being loaded, what went wrong: `describe.rs` |
//! | `layers/ID/nodes.json` | the octree of a layer of points: `octree.rs` |
//! | `layers/ID/nodes/N.bin` | the points of a node: `encode.rs` |
//! | `layers/ID/mesh.bin` | the triangles or lines of a layer: `encode.rs` |
//! | POST `files?name=NAME` | one more file, as the body |
//!
//! # Who may ask
//! Only programs of this machine: the server listens on the loopback alone, and an address is of no use without its token, which is drawn anew each time. Requests for another host
//! are refused, so no page of the web can ask under a name of its own (DNS rebinding). The page may load nothing from anywhere else.

mod assets;
mod channel;
mod describe;
mod encode;
mod octree;
mod routes;
mod state;

#[cfg(test)]
mod tests;

pub use channel::{Channel, Data, Kind, ViewLayer, ViewPlane};

use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use zeroset::monitor::Monitor;

use state::Shared;

/// Reads files for the page.
pub trait Loader: Send + Sync + 'static {
    /// The layers of a file, or one line that names the file and the remedy.
    ///
    /// # Errors
    /// If it cannot be read.
    fn load(&self, path: &Path, monitor: &dyn Monitor) -> Result<Vec<ViewLayer>, String>;
}

/// A server that cannot be started.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The port.
    #[error("port {port} of 127.0.0.1: {source}; give another --port, or 0 for any that is free")]
    Port {
        /// The port.
        port: u16,
        /// Why.
        source: std::io::Error,
    },
    /// No page in this build.
    #[error("this build of zeroset carries no page; run `cargo xtask web`, and build again")]
    NoPage,
    /// Randomness for the token.
    #[error("the system gives no random numbers for the address: {0}; try again")]
    Random(getrandom::Error),
    /// The system refuses.
    #[error("the server cannot run: {0}; try again")]
    System(#[from] std::io::Error),
}

/// How often the server looks whether it is to stop.
const LOOK: Duration = Duration::from_millis(100);
/// How long the end waits for a file that is being read.
const PATIENCE: Duration = Duration::from_secs(2);
/// Random bytes in an address.
const TOKEN_BYTES: usize = 16;

/// A server that has its address, but does not answer yet.
pub struct Viewer {
    listener: TcpListener,
    shared: Arc<Shared>,
}

impl std::fmt::Debug for Viewer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Viewer").field("listener", &self.listener).finish_non_exhaustive()
    }
}

impl Viewer {
    /// Takes a port of the loopback, 0 for any that is free. `up` names the axis that points to the sky: `z`, `-y`, and so on.
    ///
    /// # Errors
    /// If the port is taken, or there is no page in this build.
    pub fn bind(port: u16, up: &'static str, loader: impl Loader) -> Result<Self, ServeError> {
        if assets::page().is_none() {
            return Err(ServeError::NoPage);
        }
        let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
        let listener = TcpListener::bind(address).map_err(|source| ServeError::Port { port, source })?;
        listener.set_nonblocking(true)?;
        let mut random = [0; TOKEN_BYTES];
        getrandom::fill(&mut random).map_err(ServeError::Random)?;
        let token = random.iter().map(|byte| format!("{byte:02x}")).collect();
        let port = listener.local_addr()?.port();
        Ok(Self { listener, shared: Arc::new(Shared::new(port, token, up, Box::new(loader))) })
    }

    /// Where the page is.
    #[must_use]
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.shared.port, self.shared.token)
    }

    /// Answers until `stop` says so, and loads files meanwhile, one after the other.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn run(self, files: Vec<std::path::PathBuf>, stop: impl Fn() -> bool) -> Result<(), ServeError> {
        let Self { listener, shared } = self;
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
        let loading = Arc::clone(&shared);
        std::thread::spawn(move || files.iter().for_each(|path| loading.load(path, None)));
        runtime.block_on(async move {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            let app = routes::app(Arc::clone(&shared));
            let server = tokio::spawn(async move { axum::serve(listener, app).await });
            while !stop() && !server.is_finished() {
                tokio::time::sleep(LOOK).await;
            }
            shared.stop();
            server.abort();
            Ok::<(), std::io::Error>(())
        })?;
        // A file that is being read does not keep the program for long; what came from the page is removed meanwhile.
        runtime.shutdown_timeout(PATIENCE);
        Ok(())
    }
}
