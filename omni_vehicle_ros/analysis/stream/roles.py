"""Which topic of a bag is which of the wiring table, whatever namespace it lies in."""

from pathlib import Path

from omni_vehicle_ros.analysis.stream.traces import TYPES
from omni_vehicle_ros.errors import BagError


class Roles:
    """Finds the names of the wiring table for full names of topics.

    Parameters
    ----------
    path
        Of the bag, for error messages.
    namespace
        Of the vehicle; None: the one that there is.

    Attributes
    ----------
    topics
        Full names found so far, by the names of the wiring table.
    """

    def __init__(self, path: Path, namespace: str | None = None) -> None:
        self.topics: dict[str, str] = {}
        self._path = path
        self._namespace = None if namespace is None else f'/{namespace.strip("/")}'.rstrip('/')

    def role(self, topic: str, type_name: str) -> str | None:
        """Return the name in the wiring table of a topic; None if it is of another kind.

        Raises
        ------
        BagError
            Two topics have the same name in different namespaces, and none was chosen.
        """
        for name, wanted in TYPES.items():
            full = name if name.startswith('/') else f'/{name}'
            if not topic.endswith(full) or wanted != type_name:
                continue
            namespace = topic.removesuffix(full)
            if self._namespace is not None and namespace != self._namespace and not name.startswith('/'):
                continue
            if self.topics.setdefault(name, topic) != topic:
                names = ', '.join(sorted(some.removesuffix(full) or '/' for some in (topic, self.topics[name])))
                raise BagError(f'{self._path} holds several vehicles; name the namespace of one: {names}')
            return name
        return None
