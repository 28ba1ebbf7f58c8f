//! Files of the pages, which are part of the program.

use std::io::Write;
use std::sync::LazyLock;

use axum::extract::Path;
use axum::http::header::{CACHE_CONTROL, CONTENT_ENCODING, CONTENT_TYPE, ETAG, IF_NONE_MATCH};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use flate2::write::GzEncoder;

macro_rules! assets {
    ($($name:literal: $path:literal),* $(,)?) => {
        &[$(($name, include_bytes!(concat!("../assets/", $path)))),*]
    };
}

const ASSETS: &[(&str, &[u8])] = assets![
    "addon-fit.js": "xterm/addon-fit.js",
    "addon-unicode-graphemes.js": "xterm/addon-unicode-graphemes.js",
    "addon-webgl.js": "xterm/addon-webgl.js",
    "admin.css": "admin.css",
    "licenses.txt": "xterm/LICENSES.txt",
    "terminal.css": "terminal.css",
    "terminal.js": "terminal.js",
    "xterm.css": "xterm/xterm.css",
    "xterm.js": "xterm/xterm.js",
];

struct CompressedAsset {
    name: &'static str,
    bytes: Vec<u8>,
    tag: String,
}

static COMPRESSED: LazyLock<Vec<CompressedAsset>> = LazyLock::new(|| {
    let compress = |&(name, bytes): &(&'static str, &[u8])| {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        // Writing to memory does not fail.
        let _ = encoder.write_all(bytes);
        let tag = format!("\"{}\"", &blake3::hash(bytes).to_hex()[..16]);
        CompressedAsset { name, bytes: encoder.finish().unwrap_or_default(), tag }
    };
    ASSETS.iter().map(compress).collect()
});

/// Answers a request for a file. A browser that has the same file gets only a confirmation.
pub(super) async fn asset(Path(name): Path<String>, head: HeaderMap) -> Response {
    let Some(asset) = COMPRESSED.iter().find(|asset| asset.name == name) else {
        return StatusCode::NOT_FOUND.into_response();
    };
    let tags = [(ETAG, asset.tag.as_str()), (CACHE_CONTROL, "no-cache")];
    if head.get(IF_NONE_MATCH).is_some_and(|value| value.as_bytes() == asset.tag.as_bytes()) {
        return (StatusCode::NOT_MODIFIED, tags).into_response();
    }
    let content_type = match name.rsplit_once('.').map(|(_, extension)| extension) {
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        _ => "text/plain; charset=utf-8",
    };
    let head = [(CONTENT_TYPE, content_type), (CONTENT_ENCODING, "gzip")];
    (tags, head, asset.bytes.as_slice()).into_response()
}
