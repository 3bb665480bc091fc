//! What the server answers, asked as a browser or a stranger would.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Instant;

use serde_json::Value;
use zeroset::cloud::Cloud;
use zeroset::sample::{Scene, SceneKind};

use super::*;
use crate::color::{Ends, PLAIN_POINTS};
use crate::scene::{Layer, Paint, Shape};

/// A torus far from the origin, with numbers and classes; names with "bad" fail.
struct Torus;

const OFFSET: [f64; 3] = [84_810.0, 447_412.0, 3.0];
const POINTS: usize = 50_000;

fn cloud() -> Cloud {
    Cloud { world_from_local: OFFSET, ..Scene::new(SceneKind::Torus, 1).points(POINTS, 0.001, 1) }
}

impl Loader for Torus {
    fn load(&self, path: &Path, _: &dyn Monitor) -> Result<Vec<ViewLayer>, String> {
        if path.to_string_lossy().contains("bad") {
            return Err(format!("{}: it is bad; give a good one", path.display()));
        }
        let cloud = cloud();
        let x: Vec<Option<f64>> = cloud.points.iter().map(|p| (p[0] > 0.0).then_some(p[0])).collect();
        let classes = cloud.points.iter().map(|p| if p[2] > 0.0 { 6 } else { 2 }).collect();
        let channels = vec![
            Channel::height("height".into(), &[Some(2.0), Some(4.0)]),
            Channel::values("x", "x".into(), &x, Ends::Both),
            Channel { name: "class", title: "class".into(), data: Data::Classes { values: classes, name: |_| "some" } },
        ];
        let layer = Layer::points(cloud, Paint::Plain(PLAIN_POINTS), None);
        Ok(vec![ViewLayer {
            name: "torus.xyz".into(),
            kind: Kind::Points,
            world_from_local: layer.world_from_local,
            positions: layer.positions,
            shape: layer.shape,
            channels,
            shown: Some("class"),
            plain: PLAIN_POINTS,
            lifted: false,
            system: (Some("EPSG:28992".into()), Some("m")),
            planes: Vec::new(),
        }])
    }
}

/// A server that runs until it is dropped.
struct Running {
    shared: Arc<Shared>,
    _runtime: tokio::runtime::Runtime,
}

impl Running {
    fn start() -> Self {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        listener.set_nonblocking(true).unwrap();
        let port = listener.local_addr().unwrap().port();
        let shared = Arc::new(Shared::new(port, "0123456789abcdef".into(), "z", Box::new(Torus)));
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build().unwrap();
        let app = routes::app(Arc::clone(&shared));
        runtime.spawn(async move {
            let listener = tokio::net::TcpListener::from_std(listener).unwrap();
            axum::serve(listener, app).await
        });
        Self { shared, _runtime: runtime }
    }

    /// Sends bytes as they are; returns the status, the headers and the body.
    fn send(&self, request: &[u8]) -> (u16, String, Vec<u8>) {
        let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, self.shared.port)).unwrap();
        stream.write_all(request).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|w| w == b"\r\n\r\n").unwrap();
        let head = String::from_utf8(answer[..end].to_vec()).unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        (status, head.to_ascii_lowercase(), answer[end + 4..].to_vec())
    }

    fn ask(&self, method: &str, path: &str, headers: &str, body: &[u8]) -> (u16, String, Vec<u8>) {
        let host = if headers.to_ascii_lowercase().contains("host:") {
            String::new()
        } else {
            format!("Host: 127.0.0.1:{}\r\n", self.shared.port)
        };
        let length = body.len();
        let head =
            format!("{method} {path} HTTP/1.1\r\n{host}Connection: close\r\nContent-Length: {length}\r\n{headers}\r\n");
        self.send(&[head.as_bytes(), body].concat())
    }

    /// What lies beside the page.
    fn get(&self, path: &str) -> (u16, Vec<u8>) {
        let (status, _, body) = self.ask("GET", &format!("/{}/{path}", self.shared.token), "", b"");
        (status, body)
    }

    fn scene(&self) -> Value {
        let (status, body) = self.get("scene.json");
        assert_eq!(status, 200);
        serde_json::from_slice(&body).unwrap()
    }

    /// Waits for a file that was sent.
    fn settled(&self) -> Value {
        let start = Instant::now();
        loop {
            let scene = self.scene();
            let is_done =
                !scene["layers"].as_array().unwrap().is_empty() || !scene["problems"].as_array().unwrap().is_empty();
            if is_done && scene["work"].is_null() {
                return scene;
            }
            assert!(start.elapsed() < Duration::from_secs(60), "{scene}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

#[test]
fn strangers_are_refused() {
    let server = Running::start();
    server.shared.load(Path::new("torus.xyz"), None);
    let own = format!("/{}/scene.json", server.shared.token);
    for path in [
        "/",
        "/scene.json",
        "/0123456789abcdee/scene.json",
        "/0123456789abcdef0/scene.json",
        "//scene.json",
        "/index.html",
    ] {
        let (status, _, body) = server.ask("GET", path, "", b"");
        assert_eq!(status, 403, "{path}");
        let text: Value = serde_json::from_slice(&body).unwrap();
        assert!(text["error"].as_str().unwrap().len() > 10 && !text.to_string().contains("0123456789abcdef"));
    }
    let port = server.shared.port;
    for headers in [
        "Host: example.org\r\n".to_owned(),
        format!("Host: example.org:{port}\r\n"),
        "Host: 127.0.0.1:1\r\n".to_owned(),
        format!("Host: 127.0.0.1:{port}\r\nOrigin: http://example.org\r\n"),
        format!("Host: 127.0.0.1:{port}\r\nOrigin: null\r\n"),
    ] {
        assert_eq!(server.ask("GET", &own, &headers, b"").0, 403, "{headers}");
    }
    for headers in [
        format!("Host: localhost:{port}\r\n"),
        format!("Host: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\n"),
    ] {
        assert_eq!(server.ask("GET", &own, &headers, b"").0, 200, "{headers}");
    }
}

#[test]
fn nothing_outside_of_the_page_is_given() {
    let server = Running::start();
    for path in [
        "../Cargo.toml",
        "..%2f..%2fCargo.toml",
        "%2e%2e/%2e%2e/etc/passwd",
        "/etc/passwd",
        ".gitignore",
        "page.html",
        "layers/0/nodes/0.bin",
        "layers/-1/nodes.json",
        "layers/99999999999999999999/mesh.bin",
        "nothing",
    ] {
        let (status, body) = server.get(path);
        assert!((400..500).contains(&status), "{path}: {status}");
        assert!(body.len() < 300, "{path}");
    }
}

#[test]
fn answers_forbid_everything_from_elsewhere() {
    let server = Running::start();
    let (_, head, _) = server.ask("GET", &format!("/{}/scene.json", server.shared.token), "", b"");
    for wanted in [
        "default-src 'none'",
        "cache-control: no-store",
        "x-content-type-options: nosniff",
        "referrer-policy: no-referrer",
    ] {
        assert!(head.contains(wanted), "{head}");
    }
    assert!(!head.contains("access-control-allow-origin"));
}

#[test]
fn malformed_requests_do_not_stop_the_server() {
    let server = Running::start();
    let token = server.shared.token.clone();
    for request in [
        "GARBAGE\r\n\r\n".to_owned(),
        format!("GET /{token}/scene.json HTTP/1.1\r\nHost: \u{fffd}\r\nConnection: close\r\n\r\n"),
        format!(
            "DELETE /{token}/scene.json HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nConnection: close\r\n\r\n",
            server.shared.port
        ),
        format!("GET /{token}/scene.json HTTP/1.1\r\nConnection: close\r\n\r\n"),
    ] {
        assert!(server.send(request.as_bytes()).0 >= 400, "{request}");
    }
    for name in ["", ".hidden", "..", "a%2Fb.xyz", "a%5Cb.xyz", &"x".repeat(300)] {
        let (status, _, _) = server.ask("POST", &format!("/{token}/files?name={name}"), "", b"1 2 3\n");
        assert_eq!(status, 400, "{name}");
    }
    assert!(server.ask("POST", &format!("/{token}/files"), "", b"").0 >= 400);
    assert_eq!(server.scene()["layers"], serde_json::json!([]));
}

#[test]
fn points_arrive_where_they_are_with_their_values() {
    let server = Running::start();
    server.shared.load(Path::new("some/torus.xyz"), None);
    let scene = server.scene();
    assert_eq!(
        (&scene["title"], &scene["crs"], &scene["unit"]),
        (&"torus.xyz".into(), &"EPSG:28992".into(), &"m".into())
    );
    assert_eq!(scene["origin"], serde_json::json!(OFFSET));
    let layer = &scene["layers"][0];
    assert_eq!((layer["count"].as_u64(), &layer["kind"]), (Some(POINTS as u64), &"points".into()));
    let [from, to] = ["from", "to"].map(|end| layer["channels"][1][end].as_f64().unwrap());
    let (status, body) = server.get("layers/0/nodes.json");
    assert_eq!(status, 200);
    let nodes: Value = serde_json::from_slice(&body).unwrap();
    let cloud = cloud();
    let tree = zeroset::spatial::PointTree::new(&cloud.points);
    let mut seen = 0;
    for node in nodes["nodes"].as_array().unwrap() {
        let (status, data) = server.get(&format!("layers/0/nodes/{}.bin", node["id"]));
        assert_eq!((status, &data[..4]), (200, &b"ZSN1"[..]));
        let count = u32::from_le_bytes(data[4..8].try_into().unwrap()) as usize;
        assert_eq!(Some(count as u64), node["count"].as_u64());
        let short = |at: usize| u16::from_le_bytes(data[at..at + 2].try_into().unwrap());
        let values = (8 + 6 * count).next_multiple_of(4);
        let classes = (values + 2 * count).next_multiple_of(4);
        assert_eq!(data.len(), (classes + count).next_multiple_of(4));
        let side = node["side"].as_f64().unwrap();
        for i in 0..count {
            let p: [f64; 3] = std::array::from_fn(|a| {
                node["low"][a].as_f64().unwrap() + side * f64::from(short(8 + 6 * i + 2 * a)) / 65_535.0
            });
            let nearest = tree.nearest(p).unwrap();
            assert!(nearest.distance_squared.sqrt() < side / 65_535.0);
            let own = cloud.points[nearest.index];
            let step = short(values + 2 * i);
            if own[0] > 1e-4 {
                assert!((from + (to - from) * f64::from(step) / 65_534.0 - own[0]).abs() < 1e-4);
            } else if own[0] < -1e-4 {
                assert_eq!(step, u16::MAX);
            }
            if own[2].abs() > 1e-4 {
                assert_eq!(data[classes + i], if own[2] > 0.0 { 6 } else { 2 });
            }
        }
        seen += count;
    }
    assert_eq!(seen, POINTS);
}

#[test]
fn meshes_arrive_as_they_are() {
    let positions = vec![[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [0.0, 4.0, 1.0]];
    let planes = Channel { name: "plane", title: "plane".into(), data: Data::Planes(vec![Some(7), None, Some(1)]) };
    let data = encode::mesh(&positions, [10.0, 0.0, 0.0], &[[0, 1, 2]], &[planes]);
    let words: Vec<u32> = data[4..].chunks(4).map(|w| u32::from_le_bytes(w.try_into().unwrap())).collect();
    assert_eq!(words[..2], [3, 1]);
    let floats: Vec<f32> = words[2..11].iter().map(|w| f32::from_bits(*w)).collect();
    assert_eq!(floats, [10.0, 0.0, 1.0, 12.0, 0.0, 1.0, 10.0, 4.0, 1.0]);
    assert_eq!(words[11..], [0, 1, 2, 7, u32::MAX, 1]);
    assert!(matches!(Shape::Surface { triangles: vec![[0, 1, 2]] }.count(3), 1));
}

#[test]
fn a_file_from_the_page_is_added_and_a_bad_one_is_told() {
    let server = Running::start();
    let post =
        |name: &str| server.ask("POST", &format!("/{}/files?name={name}", server.shared.token), "", b"1 2 3\n").0;
    assert_eq!(post("bad.xyz"), 202);
    let told = server.settled();
    assert_eq!(told["problems"], serde_json::json!(["bad.xyz: it is bad; give a good one"]));
    assert_eq!(post("good.xyz"), 202);
    let start = Instant::now();
    while server.scene()["layers"].as_array().unwrap().is_empty() {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(20));
    }
    let scene = server.settled();
    assert!(scene["revision"].as_u64().unwrap() > told["revision"].as_u64().unwrap());
    assert_eq!(scene["layers"].as_array().unwrap().len(), 1);
}

/// Sends requests that were sound before some of their bytes were changed, cut out or doubled, for so long.
fn fuzz(time: Duration) {
    let server = Running::start();
    server.shared.load(Path::new("torus.xyz"), None);
    let (token, port) = (server.shared.token.clone(), server.shared.port);
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = move |below: usize| {
        // Xorshift, Marsaglia 2003.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as usize % below
    };
    let paths = ["", "scene.json", "layers/0/nodes.json", "layers/0/nodes/0.bin", "layers/0/mesh.bin", "page.js"];
    let start = Instant::now();
    let mut sent = 0;
    while start.elapsed() < time {
        let path = paths[random(paths.len())];
        let mut request = match random(4) {
            0 => format!(
                "POST /{token}/files?name=bad.xyz HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Length: 6\r\n\
                 Connection: close\r\n\r\n1 2 3\n"
            ),
            _ => format!("GET /{token}/{path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n"),
        }
        .into_bytes();
        for _ in 0..1 + random(4) {
            let at = random(request.len());
            match random(3) {
                0 => request[at] = random(256) as u8,
                1 => drop(request.drain(at..request.len().min(at + 1 + random(9)))),
                _ => request.extend_from_within(at..),
            }
            if request.is_empty() {
                request.push(b'\n');
            }
        }
        let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_millis(200))).unwrap();
        // The server may hang up before it has read all, and waits for what was cut off.
        let _ = stream.write_all(&request);
        let _ = stream.shutdown(std::net::Shutdown::Write);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        assert!(answer.is_empty() || answer.starts_with(b"HTTP/1."), "{}", String::from_utf8_lossy(&request));
        sent += 1;
    }
    let scene = server.settled();
    assert_eq!(scene["layers"][0]["count"], POINTS, "after {sent} requests");
    assert!(sent > 10);
}

#[test]
fn requests_with_changed_bytes_do_not_stop_the_server() {
    fuzz(Duration::from_secs(2));
}

#[test]
#[ignore = "takes a minute"]
fn requests_with_changed_bytes_do_not_stop_the_server_for_a_minute() {
    fuzz(Duration::from_secs(60));
}
