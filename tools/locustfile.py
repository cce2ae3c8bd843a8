"""Load for a running service: `locust -f tools/locustfile.py --headless -H ADDRESS -u 200 -t 60s`.

Locust is not among the locked packages (it brings gevent and Flask): `pip install locust`, outside
`.venv` if you like. Each user asks again as soon as it has its answer; times are printed, and any
answer that is not the expected one is a failure. Exit status 1 where there is one.
"""

from __future__ import annotations

import random

from locust import HttpUser, constant, task

FIXED = (
    *("/", "/v1/taxonomy", "/v1/studies?limit=20", "/v1/studies/Liebe2001", "/v1/claims/C04"),
    *("/v1/datasets/cmos-single-aperture", "/v1/leaderboard/architectures?limit=20"),
    *("/v1/leaderboard/qpd-single-aperture?limit=20", "/v1/search?q=centroid", "/v1/flows/error"),
)
WRONG = (
    *("/v1/nothing", "/v1/studies/Nobody1900", "/v1/studies?limit=-1", "/v1/datasets/none"),
    *("/v1/recommendations?max_error=abc", "/v1/results?dataset=%ff", "/v1/leaderboard/%00"),
)


class Reader(HttpUser):
    """Reads what pages and notebooks ask most, poses new questions, and errs now and then."""

    wait_time = constant(0)

    @task(12)
    def fixed(self) -> None:
        self.client.get(random.choice(FIXED), headers={"Accept-Encoding": "gzip"})

    @task(4)
    def question(self) -> None:
        asked = {
            "max_error_deg": round(10 ** random.uniform(-3, 1), 4),
            "min_fov_deg": random.choice([30, 60, 90, 120]),
        }
        self.client.get("/v1/recommendations", params=asked, name="/v1/recommendations")

    @task(1)
    def posted(self) -> None:
        asked = {"max_error_deg": round(10 ** random.uniform(-3, 1), 4)}
        self.client.post("/v1/recommendations", json=asked, name="POST /v1/recommendations")

    @task(1)
    def wrong(self) -> None:
        with self.client.get(random.choice(WRONG), name="wrong", catch_response=True) as answer:
            if 400 <= answer.status_code < 500:
                answer.success()
