"""The connection to a run that is served on this machine.

The default connection reads the port from the environment variable NOVAMIND_API_PORT and the token, if the server requires
one, from NOVAMIND_API_TOKEN.
"""
from __future__ import annotations

import json
import os
import selectors
import threading
import time
import uuid
from http.client import HTTPConnection, HTTPException, HTTPResponse
from typing import Any, Dict, Optional, Tuple

#: Seconds to wait for a response; a week of a large company takes a few.
TIMEOUT = 1800.0
#: Seconds to wait before each retry.
RETRY_WAITS = (0.1, 0.2, 0.4, 0.8, 1.6)
#: Maximum wait that a server can request, seconds.
MAX_WAIT = 10.0


class NovamindError(Exception):
    """A rejection, or a server that does not respond. The text describes the problem; ``code`` and ``field`` are for programs."""

    def __init__(self, message: str, code: Optional[str] = None, field: Optional[str] = None) -> None:
        super().__init__(message)
        self.code = code
        self.field = field


class Connection:
    """The connection to one run. Threads can share it: it sends one request after another.

    A request is retried if it gets no response or the server has too many connections. Each retry has the same ``request_id``,
    so the server runs it once.

    Args:
        port: the port of the server; default NOVAMIND_API_PORT.
        token: the token of the server; without a port, default NOVAMIND_API_TOKEN.
        timeout: seconds to wait for a response; default TIMEOUT.
    """

    def __init__(self, port: Optional[int] = None, token: Optional[str] = None, timeout: Optional[float] = None) -> None:
        self._given = (port, token)
        self._timeout = timeout
        self._lock = threading.Lock()
        self._open: Optional[HTTPConnection] = None

    def request(self, method: str, path: str, body: Optional[Dict[str, Any]] = None) -> Dict[str, Any]:
        """Sends a request and returns the JSON of the response, even if it is a rejection.

        Raises:
            NovamindError: no server responds, or it requires a token that is missing or wrong (code ``token``).
        """
        port, token = self._address()
        headers = {"Content-Type": "application/json"}
        if token:
            headers["Authorization"] = "Bearer " + token
        payload = None if body is None else json.dumps(body).encode()
        with self._lock:
            status, text = self._send_until_answered(port, method, path, payload, headers)
        try:
            answer = json.loads(text)
        except ValueError as error:
            raise NovamindError(f"the server responded with status {status}, but not with JSON", "no_json") from error
        if status == 401:
            said = answer.get("error") if isinstance(answer, dict) else None
            raise NovamindError(
                f"{said or 'the server requires a token'}; set NOVAMIND_API_TOKEN to the text of the file named by --token",
                "token",
            )
        if status == 503:
            said = answer.get("error") if isinstance(answer, dict) else None
            raise NovamindError(str(said or "the server has too many connections"), "too_many_connections")
        return answer

    def call(self, tool: str, arguments: Dict[str, Any], request_id: Optional[str] = None) -> Any:
        """Calls a tool with the arguments that are not None, and returns its data.

        Args:
            tool: the name of the tool.
            arguments: its arguments.
            request_id: the id of the request; default a new id. A request whose id was sent before is not run again.

        Raises:
            NovamindError: the tool rejected the call.
        """
        given = {name: value for name, value in arguments.items() if value is not None}
        body = {"tool": tool, "args": given, "request_id": new_id() if request_id is None else request_id}
        return checked(self.request("POST", "/call", body)).get("data")

    def _address(self) -> Tuple[int, str]:
        port, token = self._given
        if port is None:
            text = os.environ.get("NOVAMIND_API_PORT", "")
            if not text.isdigit():
                raise NovamindError(
                    "NOVAMIND_API_PORT is not the port of a server; start a server with: novamind serve", "no_port"
                )
            port = int(text)
            token = token or os.environ.get("NOVAMIND_API_TOKEN", "")
        token = (token or "").strip()
        if any(letter.isspace() or not letter.isascii() for letter in token):
            raise NovamindError("the token must not contain spaces or characters outside of ASCII", "token")
        return port, token

    def _send_until_answered(
        self, port: int, method: str, path: str, payload: Optional[bytes], headers: Dict[str, str]
    ) -> Tuple[int, bytes]:
        for wait in (*RETRY_WAITS, None):
            try:
                response, text = self._send(port, method, path, payload, headers)
                if response.status != 503 or wait is None:
                    return response.status, text
                wait = max(wait, _seconds(response.getheader("Retry-After")))
            except (OSError, HTTPException) as error:
                if wait is None:
                    raise NovamindError(f"the server on port {port} does not respond: {error}", "no_server") from error
            time.sleep(wait)
        raise AssertionError("the last attempt returns or raises")

    def _send(
        self, port: int, method: str, path: str, payload: Optional[bytes], headers: Dict[str, str]
    ) -> Tuple[HTTPResponse, bytes]:
        connection = self._open
        if connection is None or connection.port != port or _is_closed_by_server(connection):
            self._close()
            timeout = TIMEOUT if self._timeout is None else self._timeout
            connection = self._open = HTTPConnection("127.0.0.1", port, timeout=timeout)
        try:
            connection.request(method, path, payload, headers)
            response = connection.getresponse()
            return response, response.read()
        except BaseException:
            # A late response must not be read as that of the next request.
            self._close()
            raise

    def _close(self) -> None:
        if self._open is not None:
            self._open.close()
            self._open = None


def _is_closed_by_server(connection: HTTPConnection) -> bool:
    """Returns whether the server has closed the connection, which makes the socket readable."""
    if connection.sock is None:
        return False
    with selectors.DefaultSelector() as selector:
        selector.register(connection.sock, selectors.EVENT_READ)
        return bool(selector.select(timeout=0))


def _seconds(header: Optional[str]) -> float:
    return min(float(header), MAX_WAIT) if header and header.isdigit() else 0.0


def new_id() -> str:
    """Returns a new id for a request."""
    return uuid.uuid4().hex


def checked(answer: Dict[str, Any]) -> Dict[str, Any]:
    """Returns the response, unless it is a rejection.

    Raises:
        NovamindError: the response is a rejection.
    """
    if answer.get("success") is False:
        raise NovamindError(str(answer.get("message") or answer.get("error")), answer.get("code"), answer.get("field"))
    return answer


#: The connection that the functions of this package use.
default = Connection()
request = default.request
call = default.call
