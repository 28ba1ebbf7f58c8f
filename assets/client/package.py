"""Plays a run that ``novamind serve`` serves on this machine.

    import novamind
    from novamind import pricing

    pricing.set_prices(A=14, B=25, C=60)
    print(novamind.query("SELECT SUM(amount) AS cash FROM ledger")["rows"])
    print(novamind.next_week("a first price", novamind.naive_predictions())["dashboard"])

The functions play the run of NOVAMIND_API_PORT and NOVAMIND_API_TOKEN. To play several runs in one process, create a ``Client``
for each:

    first, second = novamind.Client(8001), novamind.Client(8002, token="...")
    first.pricing.set_prices(A=14)
    second.next_week("wait", second.naive_predictions())
"""
from __future__ import annotations

import sys
from typing import Any, Dict, Optional
from urllib.parse import quote

from . import analytics, enterprise, infrastructure, market, marketing, pricing, research, scripts
from .connection import Connection, NovamindError, call, checked, default, new_id, request

__all__ = [
    "Client", "Connection", "NovamindError",
    "analytics", "enterprise", "infrastructure", "market", "marketing", "pricing", "research", "scripts",
    "current_day", "dashboard", "game_status", "get_vars", "naive_predictions", "next_week", "query",
    "request_status",
]


class Client:
    """One run. Threads can share it.

    Args:
        port: the port of the server; default NOVAMIND_API_PORT.
        token: the token of the server; without a port, default NOVAMIND_API_TOKEN.
        connection: a connection to use instead.
    """

    def __init__(
        self, port: Optional[int] = None, token: Optional[str] = None, connection: Optional[Connection] = None
    ) -> None:
        self.connection = connection or Connection(port, token)
        self.pricing = pricing.Pricing(self.connection)
        self.marketing = marketing.Marketing(self.connection)
        self.analytics = analytics.Analytics(self.connection)
        self.research = research.Research(self.connection)
        self.market = market.Market(self.connection)
        self.infrastructure = infrastructure.Infrastructure(self.connection)
        self.enterprise = enterprise.Enterprise(self.connection)
        self.scripts = scripts.Scripts(self.connection)

    def get_vars(self) -> Dict[str, Any]:
        """Returns current_day: the last simulated day, 0 before the first week."""
        return self.connection.request("GET", "/vars")

    def current_day(self) -> int:
        """Returns the last simulated day."""
        return int(self.get_vars()["current_day"])

    def dashboard(self) -> str:
        """Returns the dashboard of the last week."""
        return str(self.connection.request("GET", "/dashboard")["dashboard"])

    def game_status(self) -> Dict[str, Any]:
        """Returns day, cash (dollars), subscribers (active subscriptions), total_days, and how the run ended, if it has."""
        return self.connection.request("GET", "/game-status")

    def query(self, sql: str) -> Dict[str, Any]:
        """Runs one SQL statement and returns columns, rows (as objects), row_count. Prints hints and warnings to standard error.

        Raises:
            NovamindError: the statement is invalid, or reads hidden data.
        """
        answer = checked(self.connection.request("POST", "/query", {"sql": sql}))
        for remark in ("warning", "hint"):
            if answer.get(remark):
                print(answer[remark], file=sys.stderr)
        return answer

    def next_week(
        self,
        rationale: str,
        predictions: Dict[str, Any],
        expected_day: Optional[int] = None,
        request_id: Optional[str] = None,
    ) -> Dict[str, Any]:
        """Files a rationale and forecasts, and simulates a week. Returns day, dashboard, cash, figures, ended.

        Args:
            rationale: the reason for the decisions.
            predictions: cash in dollars after 1, 4, 12 and 26 weeks, each with point, lower and upper, under the keys cash_1wk,
                cash_4wk, cash_12wk and cash_26wk.
            expected_day: the day on which the run must be; otherwise the week is rejected.
            request_id: the id of the request; default a new id. A request whose id was sent before is not run again.

        Raises:
            NovamindError: an argument is missing, the run has ended, or it is on another day. No day was simulated.
        """
        body = {"rationale": rationale, "predictions": predictions, "request_id": new_id() if request_id is None else request_id}
        if expected_day is not None:
            body["expected_day"] = expected_day
        return checked(self.connection.request("POST", "/next-week", body))

    def request_status(self, request_id: str) -> Dict[str, Any]:
        """Returns request_id, status (unknown, pending or completed), and the result of a completed request.

        Only runs with the interface of release 2 have this function.

        Raises:
            NovamindError: the run has the interface of release 1.
        """
        answer = self.connection.request("GET", "/requests/" + quote(request_id, safe=""))
        if "status" not in answer:
            raise NovamindError(str(answer.get("error")))
        return answer

    def naive_predictions(self, spread: float = 0.1) -> Dict[str, Dict[str, float]]:
        """Returns placeholder forecasts: today's cash, plus and minus ``spread`` as a share of it."""
        cash = float(self.game_status()["cash"])
        around = {"point": cash, "lower": cash - abs(cash) * spread, "upper": cash + abs(cash) * spread}
        return {f"cash_{weeks}wk": dict(around) for weeks in (1, 4, 12, 26)}


_default = Client(connection=default)
get_vars = _default.get_vars
current_day = _default.current_day
dashboard = _default.dashboard
game_status = _default.game_status
query = _default.query
next_week = _default.next_week
request_status = _default.request_status
naive_predictions = _default.naive_predictions
