//! Checks of requests: the name of the host, the origin of the page, and the address of the client.
//!
//! A page of another site can send requests to the host, but cannot choose the headers `Host` and `Origin`.

use std::net::{IpAddr, SocketAddr};

use axum::http::HeaderMap;
use axum::http::header::{COOKIE, HOST, ORIGIN};

/// Name of the cookie with the token of a participant.
pub(super) const PARTICIPANT_COOKIE: &str = "novamind-session";
/// Name of the cookie of the admin page.
pub(super) const ADMIN_COOKIE: &str = "novamind-admin";

/// The address at which participants reach the host, for example `https://play.example.org`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PublicAddress {
    /// Whether the address begins with `https`.
    pub is_secure: bool,
    /// Name or IP address, with the port if it is not the default port.
    pub authority: String,
}

impl PublicAddress {
    /// Parses `http://HOST[:PORT]` or `https://HOST[:PORT]`. A slash at the end is ignored.
    ///
    /// # Errors
    /// The text is not such an address. The error describes the expected form.
    pub fn parse(text: &str) -> Result<PublicAddress, String> {
        let address = text.trim().trim_end_matches('/').to_ascii_lowercase();
        let (is_secure, authority) = match address.split_once("://") {
            Some(("https", authority)) => (true, authority),
            Some(("http", authority)) => (false, authority),
            _ => return Err(format!("`{text}` does not begin with http:// or https://")),
        };
        let is_allowed = |c: char| c.is_ascii_alphanumeric() || "-._[]:".contains(c);
        if authority.is_empty() || !authority.chars().all(is_allowed) {
            return Err(format!("`{text}` is not an address such as https://play.example.org"));
        }
        Ok(PublicAddress { is_secure, authority: authority.to_owned() })
    }
}

/// A request that passed the checks of [`RequestGuard`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct CheckedRequest {
    /// Address of the client: of the connection, or, behind a trusted proxy, the address that the proxy reports.
    pub client: IpAddr,
    /// Name of the host in the request.
    pub host: String,
    /// Whether the client uses TLS, which ends at a trusted proxy.
    pub is_secure: bool,
}

/// Requirements that every request must meet.
#[derive(Debug, Clone)]
pub(super) struct RequestGuard {
    /// Address on which the host listens.
    pub bound: SocketAddr,
    /// Address at which participants reach the host, if it differs from `bound`.
    pub public: Option<PublicAddress>,
    /// Addresses of proxies whose `X-Forwarded-*` headers are used.
    pub trusted_proxies: Vec<IpAddr>,
}

impl RequestGuard {
    /// Checks the headers of a request from `peer`. Returns an error text if the request names another host, or comes from a
    /// page of another site. A request without `Origin` is accepted unless `needs_origin` is set.
    pub fn check(
        &self,
        head: &HeaderMap,
        peer: IpAddr,
        needs_origin: bool,
    ) -> Result<CheckedRequest, &'static str> {
        let is_proxy = self.trusted_proxies.contains(&peer.to_canonical());
        let forwarded = |name: &str| if is_proxy { single(head, name) } else { None };
        let host = single(head, HOST.as_str()).unwrap_or_default().to_ascii_lowercase();
        if !self.is_own_name(&host) {
            return Err("This address does not belong to the host. Use the link that you were given.");
        }
        let is_secure = match forwarded("x-forwarded-proto") {
            Some(protocol) => protocol.eq_ignore_ascii_case("https"),
            None => self.public.as_ref().is_some_and(|public| public.is_secure && public.authority == host),
        };
        let origins = head.get_all(ORIGIN).iter().collect::<Vec<_>>();
        let own_origin = format!("{}://{host}", if is_secure { "https" } else { "http" });
        let is_own = |origin: &axum::http::HeaderValue| {
            origin.to_str().is_ok_and(|origin| origin.eq_ignore_ascii_case(&own_origin))
        };
        if !origins.iter().all(|origin| is_own(origin)) || (needs_origin && origins.len() != 1) {
            return Err("Requests from pages of other sites are not accepted.");
        }
        // The last address was added by the trusted proxy; a client can invent the others.
        let reported =
            forwarded("x-forwarded-for").and_then(|list| list.rsplit(',').next()?.trim().parse().ok());
        Ok(CheckedRequest { client: reported.unwrap_or(peer).to_canonical(), host, is_secure })
    }

    /// Returns whether a `Host` header names this host. Names other than the public address must be IP addresses or
    /// `localhost`, so that no name of another site can be resolved to this host.
    fn is_own_name(&self, host: &str) -> bool {
        if self.public.as_ref().is_some_and(|public| public.authority == host) {
            return true;
        }
        let is_port = |port: &str| port.parse() == Ok(self.bound.port());
        if host.rsplit_once(':').is_some_and(|(name, port)| name == "localhost" && is_port(port)) {
            return self.bound.ip().is_loopback() || self.bound.ip().is_unspecified();
        }
        let Ok(address) = host.parse::<SocketAddr>() else { return false };
        address.port() == self.bound.port()
            && (self.bound.ip().is_unspecified() || address.ip() == self.bound.ip())
    }
}

/// Returns the value of a header that occurs once.
fn single<'a>(head: &'a HeaderMap, name: &str) -> Option<&'a str> {
    let mut values = head.get_all(name).iter();
    let value = values.next()?.to_str().ok()?;
    if values.next().is_some() { None } else { Some(value) }
}

/// Returns the value of a cookie.
pub(super) fn cookie<'a>(head: &'a HeaderMap, name: &str) -> Option<&'a str> {
    let values = head.get_all(COOKIE).iter().filter_map(|value| value.to_str().ok());
    values
        .flat_map(|value| value.split(';'))
        .find_map(|pair| pair.trim().strip_prefix(name)?.strip_prefix('='))
}

/// Returns the header that sets a cookie, which pages cannot read and other sites cannot send. An empty value removes it.
pub(super) fn set_cookie(name: &str, value: &str, path: &str, is_secure: bool) -> String {
    let secure = if is_secure { "; Secure" } else { "" };
    let age = if value.is_empty() { "; Max-Age=0" } else { "" };
    format!("{name}={value}; Path={path}; HttpOnly; SameSite=Strict{secure}{age}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const PEER: &str = "192.0.2.7";
    const PROXY: &str = "10.0.0.2";

    fn guard(bound: &str, public: Option<&str>) -> RequestGuard {
        RequestGuard {
            bound: bound.parse().expect("an address"),
            public: public.map(|text| PublicAddress::parse(text).expect("an address")),
            trusted_proxies: vec![PROXY.parse().expect("an address")],
        }
    }

    fn check(
        guard: &RequestGuard,
        peer: &str,
        head: &[(&str, &str)],
    ) -> Result<CheckedRequest, &'static str> {
        let mut headers = HeaderMap::new();
        for (name, value) in head {
            let name: axum::http::HeaderName = name.parse().expect("a name");
            headers.append(name, value.parse().expect("a value"));
        }
        guard.check(&headers, peer.parse().expect("an address"), false)
    }

    #[test]
    fn only_own_names_of_the_host_are_accepted() {
        let local = guard("127.0.0.1:7420", None);
        for host in ["127.0.0.1:7420", "localhost:7420", "LOCALHOST:7420"] {
            assert!(check(&local, PEER, &[("host", host)]).is_ok(), "{host}");
        }
        for host in [
            "",
            "evil.example:7420",
            "127.0.0.1",
            "127.0.0.1:80",
            "192.0.2.1:7420",
            "localhost.evil.example:7420",
        ] {
            assert!(check(&local, PEER, &[("host", host)]).is_err(), "{host}");
        }
        assert!(check(&local, PEER, &[]).is_err());
        assert!(check(&local, PEER, &[("host", "localhost:7420"), ("host", "localhost:7420")]).is_err());
        let everywhere = guard("0.0.0.0:7420", Some("https://play.example.org"));
        for host in ["play.example.org", "192.0.2.1:7420", "localhost:7420"] {
            assert!(check(&everywhere, PEER, &[("host", host)]).is_ok(), "{host}");
        }
        for host in ["play.example.org:7420", "evil.example:7420", "other.example.org"] {
            assert!(check(&everywhere, PEER, &[("host", host)]).is_err(), "{host}");
        }
    }

    #[test]
    fn origins_of_other_sites_are_refused() {
        let public = guard("127.0.0.1:7420", Some("https://play.example.org"));
        let host = ("host", "play.example.org");
        assert!(check(&public, PROXY, &[host, ("origin", "https://play.example.org")]).is_ok());
        for origin in [
            "null",
            "http://play.example.org",
            "https://play.example.org.evil.example",
            "https://evil.example",
            "",
        ] {
            assert!(check(&public, PROXY, &[host, ("origin", origin)]).is_err(), "{origin}");
        }
        let mut head = HeaderMap::new();
        head.append(HOST, "play.example.org".parse().expect("a value"));
        assert!(
            public.check(&head, PEER.parse().expect("an address"), true).is_err(),
            "an origin is missing"
        );
    }

    #[test]
    fn forwarded_headers_count_only_from_trusted_proxies() {
        let local = guard("0.0.0.0:7420", None);
        let head = [
            ("host", "192.0.2.1:7420"),
            ("x-forwarded-for", "203.0.113.9, 198.51.100.4"),
            ("x-forwarded-proto", "https"),
        ];
        let direct = check(&local, PEER, &head).expect("a request");
        assert_eq!((direct.client.to_string().as_str(), direct.is_secure), (PEER, false));
        let proxied = check(&local, PROXY, &head).expect("a request");
        assert_eq!((proxied.client.to_string().as_str(), proxied.is_secure), ("198.51.100.4", true));
        let mapped = check(&local, "::ffff:10.0.0.2", &head).expect("a request");
        assert!(mapped.is_secure);
    }

    #[test]
    fn cookies_are_found_by_their_whole_name() {
        let mut head = HeaderMap::new();
        head.append(COOKIE, "x-novamind-session=no; novamind-session=yes; other=1".parse().expect("a value"));
        assert_eq!(cookie(&head, PARTICIPANT_COOKIE), Some("yes"));
        assert_eq!(cookie(&head, ADMIN_COOKIE), None);
        assert_eq!(
            set_cookie(PARTICIPANT_COOKIE, "a", "/", true),
            "novamind-session=a; Path=/; HttpOnly; SameSite=Strict; Secure"
        );
    }

    #[test]
    fn public_addresses_have_a_protocol_and_a_name() {
        assert_eq!(
            PublicAddress::parse("https://Play.Example.org/").map(|a| a.authority).as_deref(),
            Ok("play.example.org")
        );
        for text in ["play.example.org", "ftp://x", "https://", "https://a/b", "https://a b", "https://a\"b"]
        {
            assert!(PublicAddress::parse(text).is_err(), "{text}");
        }
    }
}
