"""Write docs/thesis_claims.md and docs/controllers.md with its pictures: all of it computed anew."""

from pathlib import Path

from omni_vehicle_ros.thesis.workers import Workers

from omni_vehicle_ros.thesis import controllers_page
from omni_vehicle_ros.thesis.pages import claims_page
from omni_vehicle_ros.thesis.reproduce import judge_claims

DOCS = Path(__file__).resolve().parents[1] / 'docs'


def main() -> None:
    """Write the pages."""
    (DOCS / 'thesis_claims.md').write_text(claims_page(judge_claims()), encoding='utf-8')
    with Workers() as workers:
        results = workers.results(controllers_page.TASKS, lambda: None)
    controllers_page.write_controllers_page(results, DOCS)


if __name__ == '__main__':
    main()
