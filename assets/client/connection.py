"""The connection to a run that is served on this machine.

The default connection takes the port from the environment variable NOVAMIND_API_PORT and the token, if the server asks for
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

#: Seconds that an answer is waited for; a week of a large company takes a few.
TIMEOUT = 1800.0
#: Seconds to wait before each retry.
RETRY_WAITS = (0.1, 0.2, 0.4, 0.8, 1.6)
#: Longest wait that a server can ask for, seconds.
MAX_WAIT = 10.0


class NovamindError(Exception):
    """A refusal, or a server that does not answer. Its text says what is wrong; ``code`` and ``field`` are for programs."""

    def __init__(self, message: str, code: Optional[str] = None, field: Optional[str] = None) -> None:
        super().__init__(message)
        self.code = code
        self.field = field


class Connection:
    """The connection to one run. Threads can share it: it sends one request after the other.

    A request that got no answer, or found the server full, is sent again. It carries the same ``request_id`` each time, so
    the server runs it once.

    Args:
        port: the port of the server; without it NOVAMIND_API_PORT.
        token: the token of the server; without a port NOVAMIND_API_TOKEN.
        timeout: seconds that an answer is waited for; without it TIMEOUT.
    """

    def __init__(self, port: Optional[int] = None, token: Optional[str] = None, timeout: Optional[float] = None) -> None:
        self._given = (port, token)
        self._timeout = timeout
        self._lock = threading.Lock()
        self._open: Optional[HTTPConnection] = None

    def request(self, method: str, path: str, body: Optional[Dict[str, Any]] = None) -> Dict[str, Any]:
        """Sends a request and returns its JSON, whatever it says.

        Raises:
            NovamindError: no server answers, or it wants a token that was not given (code ``token``).
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
            raise NovamindError(f"the server answered {status} and something else than JSON", "no_json") from error
        if status == 401:
            said = answer.get("error") if isinstance(answer, dict) else None
            raise NovamindError(
                f"{said or 'the server wants a token'}; set NOVAMIND_API_TOKEN to the text of the file named by --token",
                "token",
            )
        if status == 503:
            said = answer.get("error") if isinstance(answer, dict) else None
            raise NovamindError(str(said or "the server is full"), "too_many_connections")
        return answer

    def call(self, tool: str, arguments: Dict[str, Any], request_id: Optional[str] = None) -> Any:
        """Calls a tool with the arguments that are not None, and returns its data.

        Args:
            tool: the name of the tool.
            arguments: its arguments.
            request_id: the id of the request; without it a new one. A request with an id that was sent before is not run again.

        Raises:
            NovamindError: the refusal of the tool.
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
                    "NOVAMIND_API_PORT does not hold the port of a server; start one with: novamind serve", "no_port"
                )
            port = int(text)
            token = token or os.environ.get("NOVAMIND_API_TOKEN", "")
        token = (token or "").strip()
        if any(letter.isspace() or not letter.isascii() for letter in token):
            raise NovamindError("the token holds more than a token", "token")
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
                    raise NovamindError(f"the server on port {port} does not answer: {error}", "no_server") from error
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
            # An answer that comes later must not be taken for that of the next request.
            self._close()
            raise

    def _close(self) -> None:
        if self._open is not None:
            self._open.close()
            self._open = None


def _is_closed_by_server(connection: HTTPConnection) -> bool:
    """Whether the other end has closed: then there is something to read, which is the end."""
    if connection.sock is None:
        return False
    with selectors.DefaultSelector() as selector:
        selector.register(connection.sock, selectors.EVENT_READ)
        return bool(selector.select(timeout=0))


def _seconds(header: Optional[str]) -> float:
    return min(float(header), MAX_WAIT) if header and header.isdigit() else 0.0


def new_id() -> str:
    """A new id for a request."""
    return uuid.uuid4().hex


def checked(answer: Dict[str, Any]) -> Dict[str, Any]:
    """The answer, unless it is a refusal.

    Raises:
        NovamindError: what was refused, and why.
    """
    if answer.get("success") is False:
        raise NovamindError(str(answer.get("error")), answer.get("code"), answer.get("field"))
    return answer


#: The connection of the functions of this package.
default = Connection()
request = default.request
call = default.call
