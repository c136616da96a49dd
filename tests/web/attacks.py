"""What a server is asked by who should not get it; none of it may be let in."""

from __future__ import annotations

FOREIGN_HOSTS = (
    "evil.example",
    "127.0.0.1.evil.example",
    "localhost.evil.example:8700",
    "192.168.1.2:8700",
    "lab-pc",
    "localhost:8700:1",
    "user@localhost",
    "localhost, evil.example",
)
"""Names that a server of this computer alone does not answer to."""

FOREIGN_ORIGINS = (
    "http://evil.example",
    "http://localhost:8700",
    "http://127.0.0.1:8700.evil.example",
    "null",
    "",
)
"""Origins of pages that are not those of a server on 127.0.0.1."""

PATHS = (
    "/../secret.txt",
    "/%2e%2e/secret.txt",
    "/..%2fsecret.txt",
    "/%2e%2e%2fsecret.txt",
    "/..%5csecret.txt",
    "/%252e%252e/secret.txt",
    "/vendor/../../secret.txt",
    "/vendor/%2e%2e/%2e%2e/secret.txt",
    "/.%00./secret.txt",
    "/main.js%00",
    "//main.js",
    "/%2fetc/passwd",
    "/.hidden",
    "/vendor",
    "/vendor/",
    "/main.js/",
    "/nothing.js",
    "/" + 300 * "a",
    "/" + 300 * "a/",
    "/%ff",
)
"""Paths that lead out of the page's folder, or to nothing."""

CHUNKED = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n\r\n"

BAD_CHUNKS = (b"zz\r\nabc\r\n0\r\n\r\n", b"-5\r\nabc\r\n")
"""What follows `CHUNKED` and is no chunk."""

HALVES = (b"", b"GET / HTTP/1.1\r\nHost: 127")
"""Requests that are not finished."""

EVIL_HTML = (
    '<img src=x onerror="alert(1)">',
    "<script>alert(1)</script>",
    "</script><script>alert(1)</script>",
    "javascript:alert(1)",
    "' onmouseover='alert(1)",
)
"""Texts in a record that would run in a careless page."""

FORMULAS = ("=1+1", '=HYPERLINK("http://evil.example","x")', "+cmd|' /C calc'!A0")
FORMULAS += ("-2+3+cmd|' /C calc'!A0", "@SUM(1,1)", "\t=1+1", "\r=1+1", "a\r=1+1")
"""Texts that a spreadsheet would take for a formula."""
