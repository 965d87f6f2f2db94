//! Who is answered: requests that know the link, and were meant for this machine.
use std::net::SocketAddr;

use ctutils::CtEq as _;

use super::request::HttpRequest;

/// Bytes of chance in a link.
const CHANCE: usize = 16;

/// What a request has to know.
#[derive(Debug)]
pub(super) struct Access {
    address: SocketAddr,
    token: [u8; 2 * CHANCE],
}

/// Why a request is not answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AccessDenied {
    /// Of methods there is GET.
    Method,
    /// It names another host: some page has a name of its own lead here.
    Host,
    /// It does not know the link.
    Token,
}

impl Access {
    /// A new token for a server at an address.
    ///
    /// # Errors
    /// If the system has no random numbers.
    pub fn new(address: SocketAddr) -> Result<Access, getrandom::Error> {
        let mut chance = [0; CHANCE];
        getrandom::fill(&mut chance)?;
        let mut token = [0; 2 * CHANCE];
        for (pair, byte) in token.chunks_exact_mut(2).zip(chance) {
            pair.copy_from_slice(format!("{byte:02x}").as_bytes());
        }
        Ok(Access { address, token })
    }

    /// The address of the page.
    pub fn link(&self) -> String {
        format!(
            "http://{}/{}/",
            self.address,
            String::from_utf8_lossy(&self.token)
        )
    }

    /// What a request asks for, below the token.
    ///
    /// # Errors
    /// If it is not to be answered.
    pub fn admit<'r>(&self, request: &'r HttpRequest) -> Result<&'r str, AccessDenied> {
        if request.method != "GET" {
            return Err(AccessDenied::Method);
        }
        let port = self.address.port();
        let hosts = [self.address.to_string(), format!("localhost:{port}")];
        if !hosts
            .iter()
            .any(|host| host.eq_ignore_ascii_case(&request.host))
        {
            return Err(AccessDenied::Host);
        }
        let path = request.path.strip_prefix('/').ok_or(AccessDenied::Token)?;
        let (token, rest) = path.split_once('/').ok_or(AccessDenied::Token)?;
        // How long it takes says nothing of the token but its length, which everybody knows.
        match token.as_bytes().ct_eq(&self.token[..]).to_bool() {
            true => Ok(rest),
            false => Err(AccessDenied::Token),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn access() -> Access {
        Access::new("127.0.0.1:8000".parse().unwrap()).unwrap()
    }

    fn request(method: &str, host: &str, path: &str) -> HttpRequest {
        HttpRequest {
            method: method.to_owned(),
            host: host.to_owned(),
            path: path.to_owned(),
        }
    }

    fn refused(access: &Access, method: &str, host: &str, path: &str) -> AccessDenied {
        access.admit(&request(method, host, path)).unwrap_err()
    }

    #[test]
    fn whoever_knows_the_link_is_admitted() {
        let access = access();
        let link = access.link();
        let path = link.strip_prefix("http://127.0.0.1:8000").unwrap();
        for host in ["127.0.0.1:8000", "localhost:8000", "LocalHost:8000"] {
            assert_eq!(access.admit(&request("GET", host, path)), Ok(""));
            let events = format!("{path}events");
            assert_eq!(access.admit(&request("GET", host, &events)), Ok("events"));
        }
    }

    #[test]
    fn nobody_else_is() {
        let access = access();
        let link = access.link();
        let path = link.strip_prefix("http://127.0.0.1:8000").unwrap();
        let token = path.trim_matches('/');
        let host = "127.0.0.1:8000";
        let mut wrong = token.to_owned();
        let last = if wrong.pop() == Some('0') { '1' } else { '0' };
        wrong.push(last);
        for path in [
            "/".to_owned(),
            "//".to_owned(),
            "*".to_owned(),
            String::new(),
            format!("/{token}"),
            format!("/{wrong}/"),
            format!("/{token}{token}/"),
            format!("/{}/", &token[1..]),
            format!(
                "/{}/",
                token
                    .to_uppercase()
                    .replace(|c: char| c.is_ascii_digit(), "G")
            ),
            format!("/?/{token}/"),
            format!("{link}events"),
        ] {
            let refused = refused(&access, "GET", host, &path);
            assert_eq!(refused, AccessDenied::Token, "{path}");
        }
        for host in [
            "",
            "127.0.0.1",
            "127.0.0.1:80",
            "localhost",
            "evil.example:8000",
            "127.0.0.1:8000.evil.example",
            "[::1]:8000",
            " 127.0.0.1:8000",
        ] {
            let refused = refused(&access, "GET", host, path);
            assert_eq!(refused, AccessDenied::Host, "{host}");
        }
        for method in ["POST", "HEAD", "OPTIONS", "get", "PUT", "DELETE", "CONNECT"] {
            let refused = refused(&access, method, host, path);
            assert_eq!(refused, AccessDenied::Method, "{method}");
        }
    }

    #[test]
    fn no_two_links_are_the_same() {
        let links: std::collections::BTreeSet<String> = (0..100).map(|_| access().link()).collect();
        assert_eq!(links.len(), 100);
    }

    #[test]
    fn without_ipv4_the_link_has_the_other_address() {
        let access = Access::new("[::1]:8000".parse().unwrap()).unwrap();
        let link = access.link();
        let path = link.strip_prefix("http://[::1]:8000").unwrap();
        assert_eq!(access.admit(&request("GET", "[::1]:8000", path)), Ok(""));
        let other = refused(&access, "GET", "127.0.0.1:8000", path);
        assert_eq!(other, AccessDenied::Host);
    }
}
