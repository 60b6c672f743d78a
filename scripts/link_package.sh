#!/bin/sh
# Installs the package editable into the virtual environment $1 and lays it out as an ament prefix of symbolic
# links, so that ament_index, `ros2 run` and `ros2 launch` find it there. Needs no network.
set -eu
venv=$1
package=omni_vehicle_ros
index=$venv/share/ament_index/resource_index/packages
share=$venv/share/$package
lib=$venv/lib/$package

# Before the installation: it would write its copies of config/ through links of an earlier set-up.
rm -rf "$share" "$lib"
"$venv/bin/uv" pip install --quiet --offline --python "$venv" --no-deps --no-build-isolation --editable .
rm -rf "$share"

mkdir -p "$index" "$share/launch" "$lib"
ln -sf "../../../../../resource/$package" "$index/$package"
ln -s ../../../package.xml ../../../config ../../../rviz ../../../urdf "$share"
# One by one: ros2 launch looks into no linked folder.
for file in launch/*.launch.py; do
    ln -s "../../../../$file" "$share/$file"
done
list="from importlib.metadata import distribution; print(*distribution('$package').entry_points.names)"
for executable in $("$venv/bin/python" -c "$list"); do
    ln -s "../../bin/$executable" "$lib/$executable"
done
