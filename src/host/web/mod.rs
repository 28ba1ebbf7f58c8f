//! The web server of a host: the terminal of participants, and the page of the experimenter.

mod admin;
mod admin_page;
mod assets;
mod attempt_limit;
mod pages;
mod received_inputs;
mod request_guard;
mod socket;
#[cfg(test)]
mod tests;

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, REFERRER_POLICY, UPGRADE, X_CONTENT_TYPE_OPTIONS, X_FRAME_OPTIONS,
};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Extension, Router};
use hyper::body::Incoming;
use hyper::service::Service;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;

use crate::sessions::Sessions;
use admin::AdminAccess;
use attempt_limit::AttemptLimit;
use received_inputs::ReceivedInputs;
pub use request_guard::PublicAddress;
use request_guard::{CheckedRequest, PARTICIPANT_COOKIE, RequestGuard, cookie};

/// Maximum number of open connections. Additional connections wait until another one is closed.
const MAX_CONNECTIONS: usize = 1024;
/// Time limit for the arrival of a request's headers.
const HEAD_DEADLINE: Duration = Duration::from_secs(10);
/// Time limit for a request, including its body. Ending a session can take 15 s.
const REQUEST_DEADLINE: Duration = Duration::from_secs(60);
/// Number of wrong tokens of an address without a waiting time. A class can share an address.
const FREE_WRONG_TOKENS: u32 = 20;

/// Settings of the web server.
#[derive(Debug, Clone)]
pub struct WebOptions {
    /// Address at which participants reach the host, if it differs from the address on which the host listens.
    pub public: Option<PublicAddress>,
    /// Addresses of proxies whose `X-Forwarded-*` headers are used.
    pub trusted_proxies: Vec<IpAddr>,
}

/// Everything that requests use. Copies refer to the same values.
#[derive(Debug, Clone)]
struct WebHost(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    sessions: Sessions,
    guard: RequestGuard,
    inputs: ReceivedInputs,
    wrong_tokens: AttemptLimit,
    admin: AdminAccess,
}

impl WebHost {
    fn sessions(&self) -> &Sessions {
        &self.0.sessions
    }

    fn inputs(&self) -> &ReceivedInputs {
        &self.0.inputs
    }

    fn wrong_tokens(&self) -> &AttemptLimit {
        &self.0.wrong_tokens
    }

    fn admin(&self) -> &AdminAccess {
        &self.0.admin
    }
}

/// The address from which a connection comes.
#[derive(Debug, Clone, Copy)]
struct Peer(IpAddr);

/// Serves participants and the experimenter. Runs until it is dropped. `bound` is the address of the listener.
pub async fn serve_web(listener: TcpListener, bound: SocketAddr, sessions: Sessions, options: WebOptions) {
    let guard = RequestGuard { bound, public: options.public, trusted_proxies: options.trusted_proxies };
    let shared = Shared {
        sessions,
        guard,
        inputs: ReceivedInputs::default(),
        wrong_tokens: AttemptLimit::new(FREE_WRONG_TOKENS),
        admin: AdminAccess::new(),
    };
    let service = TowerToHyperService::new(router(WebHost(Arc::new(shared))));
    let places = Arc::new(Semaphore::new(MAX_CONNECTIONS));
    let mut http = hyper::server::conn::http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(HEAD_DEADLINE);
    loop {
        let Ok(place) = places.clone().acquire_owned().await else { return };
        let (stream, peer) = match listener.accept().await {
            Ok((stream, peer)) => (stream, Peer(peer.ip().to_canonical())),
            // Too many files are open, or the client closed the connection. The next attempt may succeed.
            Err(_) => {
                tokio::time::sleep(Duration::from_millis(20)).await;
                continue;
            }
        };
        // Keys and frames are small and must not wait for more data.
        let _ = stream.set_nodelay(true);
        let service = service.clone();
        let with_peer = hyper::service::service_fn(move |mut request: hyper::Request<Incoming>| {
            request.extensions_mut().insert(peer);
            service.call(request)
        });
        let connection = http.serve_connection(TokioIo::new(stream), with_peer).with_upgrades();
        tokio::spawn(async move {
            // A client that disconnects does not affect the host.
            let _ = connection.await;
            drop(place);
        });
    }
}

fn router(host: WebHost) -> Router {
    Router::new()
        .route("/", get(pages::terminal_page))
        .route("/s/{token}", get(pages::open_link))
        .route("/socket", get(open_socket))
        .route("/assets/{name}", get(assets::asset))
        .merge(admin::routes())
        .fallback(|| async {
            let page = pages::message_page("Page not found", "Open the link that you were given.");
            (StatusCode::NOT_FOUND, page)
        })
        .layer(axum::middleware::from_fn_with_state(host.clone(), check_request))
        .with_state(host)
}

/// Checks a request, and adds the headers that restrict what the page may do.
async fn check_request(
    State(host): State<WebHost>,
    Extension(Peer(peer)): Extension<Peer>,
    mut request: Request,
    next: Next,
) -> Response {
    let is_reading = matches!(*request.method(), Method::GET | Method::HEAD);
    // The address of a link must not leave the page. Forms need a policy with which browsers send their origin.
    let is_admin_page = request.uri().path().starts_with("/admin");
    let referrer_policy = if is_admin_page { "same-origin" } else { "no-referrer" };
    let needs_origin = !is_reading || request.headers().contains_key(UPGRADE);
    let mut response = match host.0.guard.check(request.headers(), peer, needs_origin) {
        Ok(checked) => {
            request.extensions_mut().insert(checked);
            let answered = tokio::time::timeout(REQUEST_DEADLINE, next.run(request)).await;
            answered.unwrap_or_else(|_| StatusCode::REQUEST_TIMEOUT.into_response())
        }
        Err(problem) => (StatusCode::FORBIDDEN, pages::message_page("Not allowed", problem)).into_response(),
    };
    let head = response.headers_mut();
    let mut set_default = |name: HeaderName, value: &'static str| {
        head.entry(name).or_insert(HeaderValue::from_static(value));
    };
    set_default(
        CONTENT_SECURITY_POLICY,
        "default-src 'none'; style-src 'self'; img-src data:; form-action 'self'; base-uri 'none'; frame-ancestors 'none'",
    );
    set_default(REFERRER_POLICY, referrer_policy);
    set_default(X_CONTENT_TYPE_OPTIONS, "nosniff");
    set_default(X_FRAME_OPTIONS, "DENY");
    set_default(CACHE_CONTROL, "no-store");
    response
}

async fn open_socket(
    State(host): State<WebHost>,
    Extension(request): Extension<CheckedRequest>,
    head: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    let label = cookie(&head, PARTICIPANT_COOKIE).and_then(|token| host.sessions().label_for_token(token));
    let address = request.client.to_string();
    upgrade
        .max_message_size(socket::MAX_MESSAGE_BYTES)
        .max_frame_size(socket::MAX_MESSAGE_BYTES)
        .on_upgrade(move |socket| socket::serve_page(socket, host, label, address))
}
