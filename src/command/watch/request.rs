//! Requests, as far as they are read: a line, and headers, of which one counts.
use httparse::{EMPTY_HEADER, Status};

/// Bytes of line and headers.
pub(super) const MOST_BYTES: usize = 8 << 10;
/// Headers of a request; browsers send some 15.
const MOST_HEADERS: usize = 64;

/// What somebody asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct HttpRequest {
    pub method: String,
    pub path: String,
    /// Empty: none is named.
    pub host: String,
}

/// Why a request cannot be understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BadRequest {
    /// It is not HTTP.
    Malformed,
    /// It has too many bytes or headers.
    TooLarge,
}

impl HttpRequest {
    /// The request that begins with these bytes; `None`: there has to be more of it.
    ///
    /// # Errors
    /// If nothing that may follow makes it one.
    pub fn parse(bytes: &[u8]) -> Result<Option<HttpRequest>, BadRequest> {
        let mut headers = [EMPTY_HEADER; MOST_HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        match request.parse(bytes) {
            Ok(Status::Complete(_)) => {}
            Ok(Status::Partial) if bytes.len() < MOST_BYTES => return Ok(None),
            Ok(Status::Partial) | Err(httparse::Error::TooManyHeaders) => {
                return Err(BadRequest::TooLarge);
            }
            Err(_) => return Err(BadRequest::Malformed),
        }
        let mut hosts = (request.headers.iter()).filter(|it| it.name.eq_ignore_ascii_case("host"));
        let host = hosts.next().map_or(&b""[..], |it| it.value);
        // Which of two counts is for nobody to guess.
        if hosts.next().is_some() {
            return Err(BadRequest::Malformed);
        }
        let host = std::str::from_utf8(host).map_err(|_| BadRequest::Malformed)?;
        Ok(Some(HttpRequest {
            method: request.method.unwrap_or_default().to_owned(),
            path: request.path.unwrap_or_default().to_owned(),
            host: host.to_owned(),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: &str = "GET /a/b HTTP/1.1\r\nAccept: */*\r\nhOST: here:1\r\n\r\n";

    #[test]
    fn a_request_is_understood_once_it_is_whole() {
        for length in 0..WHOLE.len() {
            let part = &WHOLE.as_bytes()[..length];
            assert_eq!(HttpRequest::parse(part), Ok(None), "{length}");
        }
        let expected = HttpRequest {
            method: "GET".to_owned(),
            path: "/a/b".to_owned(),
            host: "here:1".to_owned(),
        };
        // What follows is not looked at.
        for more in ["", "GET /", "\0\0"] {
            let request = HttpRequest::parse(format!("{WHOLE}{more}").as_bytes());
            assert_eq!(request, Ok(Some(expected.clone())), "{more:?}");
        }
    }

    #[test]
    fn what_is_no_request_is_told() {
        for text in [
            "\0",
            "GET\r\n\r\n",
            "GET / HTTP/2.0\r\n\r\n",
            "GET / SMTP\r\n\r\n",
            "GET / HTTP/1.1\r\nHost here\r\n\r\n",
            "GET / HTTP/1.1\r\nHost: a\r\nHost: a\r\n\r\n",
            "GET / HTTP/1.1\r\n Host: a\r\n\r\n",
            "GET / HTTP/1.1\r\nHost: a\0b\r\n\r\n",
            "G@T \u{7f} HTTP/1.1\r\n\r\n",
            "\u{16}\u{3}\u{1}\u{2}\0\u{1}\0",
        ] {
            let request = HttpRequest::parse(text.as_bytes());
            assert_eq!(request, Err(BadRequest::Malformed), "{text:?}");
        }
        let host = b"GET / HTTP/1.1\r\nHost: \xff\r\n\r\n";
        assert_eq!(HttpRequest::parse(host), Err(BadRequest::Malformed));
    }

    #[test]
    fn what_is_too_large_is_told() {
        let long = format!("GET /{}", "a".repeat(MOST_BYTES));
        assert_eq!(
            HttpRequest::parse(&long.as_bytes()[..MOST_BYTES - 1]),
            Ok(None)
        );
        let full = &long.as_bytes()[..MOST_BYTES];
        assert_eq!(HttpRequest::parse(full), Err(BadRequest::TooLarge));
        let many = format!(
            "GET / HTTP/1.1\r\n{}\r\n",
            "a: b\r\n".repeat(MOST_HEADERS + 1)
        );
        assert_eq!(
            HttpRequest::parse(many.as_bytes()),
            Err(BadRequest::TooLarge)
        );
    }

    #[test]
    fn no_host_is_an_empty_one() {
        let request = HttpRequest::parse(b"GET / HTTP/1.0\r\n\r\n")
            .unwrap()
            .unwrap();
        assert_eq!(request.host, "");
    }
}
