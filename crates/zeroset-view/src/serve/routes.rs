//! What is answered to which request.

use std::io::Write;
use std::sync::Arc;

use axum::Router;
use axum::body::Body;
use axum::extract::{Path, Query, Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use futures_util::StreamExt;
use serde::Deserialize;

use super::state::{Served, Shared};
use super::{assets, describe};

/// The longest file that is taken from the page, in bytes. Larger ones are named on the command line.
const LONGEST_FILE: u64 = 1 << 30;
/// The longest name of a file.
const LONGEST_NAME: usize = 200;

/// Sent with every answer: nothing is kept, nothing comes from elsewhere, nobody else frames the page.
const HEADERS: [(HeaderName, &str); 6] = [
    (header::CACHE_CONTROL, "no-store"),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
];

/// All that is answered. What has not the token is refused, whatever it asks for.
pub(super) fn app(shared: Arc<Shared>) -> Router {
    let below = |path: &str| format!("/{}/{path}", shared.token);
    Router::new()
        .route(&below(""), get(page))
        .route(&below("{file}"), get(asset))
        .route(&below("scene.json"), get(scene))
        .route(&below("layers/{layer}/nodes.json"), get(nodes))
        .route(&below("layers/{layer}/nodes/{node}"), get(node))
        .route(&below("layers/{layer}/mesh.bin"), get(mesh))
        .route(&below("files"), post(file))
        .fallback(unknown)
        .method_not_allowed_fallback(wrong_method)
        .layer(from_fn_with_state(Arc::clone(&shared), guard))
        .with_state(shared)
}

/// A refusal, as one line.
struct Refused(StatusCode, String);

impl IntoResponse for Refused {
    fn into_response(self) -> Response {
        let text = serde_json::json!({ "error": self.1 }).to_string();
        (self.0, [(header::CONTENT_TYPE, "application/json")], text).into_response()
    }
}

/// Refuses other hosts, and adds the headers.
async fn guard(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    let mut answer = if is_for_us(request.headers(), shared.port) {
        next.run(request).await
    } else {
        Refused(StatusCode::FORBIDDEN, "this address is for the machine itself".into()).into_response()
    };
    for (name, value) in HEADERS {
        answer.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    answer
}

/// Whether a request names this machine, and comes from this page or from no page at all.
fn is_for_us(headers: &HeaderMap, port: u16) -> bool {
    let hosts = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    let is_ours = |value: &HeaderValue| value.to_str().is_ok_and(|text| hosts.iter().any(|host| host == text));
    let is_our_origin = |value: &HeaderValue| {
        value
            .to_str()
            .is_ok_and(|text| text.strip_prefix("http://").is_some_and(|rest| hosts.iter().any(|h| h == rest)))
    };
    headers.get(header::HOST).is_some_and(is_ours) && headers.get(header::ORIGIN).is_none_or(is_our_origin)
}

async fn unknown(State(shared): State<Arc<Shared>>, request: Request) -> Refused {
    if request.uri().path().strip_prefix('/').is_some_and(|path| path.starts_with(&format!("{}/", shared.token))) {
        Refused(StatusCode::NOT_FOUND, "there is nothing at this address".into())
    } else {
        Refused(StatusCode::FORBIDDEN, "this is not the address that `zeroset view` printed; open that one".into())
    }
}

async fn wrong_method() -> Refused {
    Refused(StatusCode::METHOD_NOT_ALLOWED, "this address is not asked in that way".into())
}

async fn page() -> Result<Response, Refused> {
    let page = assets::page().ok_or_else(nothing)?;
    Ok(([(header::CONTENT_TYPE, "text/html; charset=utf-8")], page).into_response())
}

async fn asset(Path(file): Path<String>) -> Result<Response, Refused> {
    let (media_type, data) = assets::beside(&file).ok_or_else(nothing)?;
    Ok(([(header::CONTENT_TYPE, media_type)], data).into_response())
}

async fn scene(State(shared): State<Arc<Shared>>) -> Result<Response, Refused> {
    let text = {
        let state = shared.state();
        serde_json::to_string(&describe::scene(&state, shared.up))
    };
    json(text)
}

async fn nodes(State(shared): State<Arc<Shared>>, Path(layer): Path<usize>) -> Result<Response, Refused> {
    let served = find(&shared, layer)?;
    json(serde_json::to_string(&describe::nodes(&served)))
}

async fn node(
    State(shared): State<Arc<Shared>>,
    Path((layer, node)): Path<(usize, String)>,
) -> Result<Response, Refused> {
    let number = node.strip_suffix(".bin").and_then(|number| number.parse().ok()).ok_or_else(nothing)?;
    let served = find(&shared, layer)?;
    bytes(move || served.node(number)).await
}

async fn mesh(State(shared): State<Arc<Shared>>, Path(layer): Path<usize>) -> Result<Response, Refused> {
    let served = find(&shared, layer)?;
    bytes(move || served.mesh()).await
}

fn nothing() -> Refused {
    Refused(StatusCode::NOT_FOUND, "there is nothing at this address".into())
}

fn fault(why: impl std::fmt::Display) -> Refused {
    Refused(StatusCode::INTERNAL_SERVER_ERROR, format!("the server failed: {why}"))
}

fn find(shared: &Shared, layer: usize) -> Result<Arc<Served>, Refused> {
    shared.state().layers.get(layer).cloned().ok_or_else(nothing)
}

fn json(text: serde_json::Result<String>) -> Result<Response, Refused> {
    let text = text.map_err(fault)?;
    Ok(([(header::CONTENT_TYPE, "application/json")], text).into_response())
}

/// Bytes that take a moment to put together.
async fn bytes(make: impl FnOnce() -> Option<Vec<u8>> + Send + 'static) -> Result<Response, Refused> {
    let made = tokio::task::spawn_blocking(make).await.map_err(fault)?.ok_or_else(nothing)?;
    Ok(([(header::CONTENT_TYPE, "application/octet-stream")], made).into_response())
}

#[derive(Debug, Deserialize)]
struct FileName {
    name: String,
}

/// Takes a file from the page, into a folder that goes when it is read.
async fn file(
    State(shared): State<Arc<Shared>>,
    Query(FileName { name }): Query<FileName>,
    body: Body,
) -> Result<StatusCode, Refused> {
    let is_plain =
        !name.is_empty() && name.len() <= LONGEST_NAME && !name.contains(['/', '\\', '\0']) && !name.starts_with('.');
    if !is_plain {
        return Err(Refused(StatusCode::BAD_REQUEST, "the file has no name of its own; rename it".into()));
    }
    let folder = tempfile::tempdir().map_err(fault)?;
    let path = folder.path().join(&name);
    let mut file = std::fs::File::create(&path).map_err(fault)?;
    let mut length = 0;
    let mut parts = body.into_data_stream();
    while let Some(part) = parts.next().await {
        let part =
            part.map_err(|_| Refused(StatusCode::BAD_REQUEST, format!("{name}: it did not arrive whole; try again")))?;
        length += part.len() as u64;
        if length > LONGEST_FILE {
            let what = format!("{name}: more than 1 GB; name it on the command line");
            return Err(Refused(StatusCode::PAYLOAD_TOO_LARGE, what));
        }
        file.write_all(&part).map_err(fault)?;
    }
    drop(file);
    tokio::task::spawn_blocking(move || {
        shared.load(&path, Some(&name));
        drop(folder);
    });
    Ok(StatusCode::ACCEPTED)
}
