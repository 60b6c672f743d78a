import ast

import pytest


def test_imports_go_downwards_only(root, monkeypatch, capsys):
    cli = pytest.importorskip('importlinter.cli')
    monkeypatch.chdir(root)
    broken = cli.lint_imports(config_filename=str(root / 'pyproject.toml'), cache_dir=None)
    assert broken == 0, capsys.readouterr().out


def test_rclpy_is_imported_by_the_nodes_and_their_benchmarks_only(root):
    # Unlike import-linter, this needs nothing but Python, and sees imports that are hidden in functions.
    package = root / 'omni_vehicle_ros'
    for path in package.rglob('*.py'):
        imported = set()
        for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
            if isinstance(node, ast.Import):
                imported |= {alias.name.split('.')[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                imported.add((node.module or '').split('.')[0])
        if 'rclpy' in imported:
            assert path.relative_to(package).parts[0] in ('nodes', 'bench'), path
