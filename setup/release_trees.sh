#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Writes what the last commit has as two packages beside each other, as ROS's bloom and build farm need them. They look for no
# package inside another one, and reject keys of packages that pip alone has. Without mcap the server writes no log and says so.
# usage: release_trees.sh FOLDER
set -eu

PIP_ONLY='mcap-ros2-support|python3-rosbags-pip'

root=$(cd "$(dirname "$0")/.." && pwd)
rm -rf "$1"
mkdir -p "$1/contact_dynamics"
folder=$(cd "$1" && pwd)
git -C "$root" archive HEAD | tar x -C "$folder/contact_dynamics"
mv "$folder/contact_dynamics/contact_dynamics_interfaces" "$folder"
cp "$folder/contact_dynamics/LICENSE" "$folder/contact_dynamics_interfaces"
sed -i 's|file="../LICENSE"|file="LICENSE"|' "$folder/contact_dynamics_interfaces/package.xml"
sed -i -E "/<(exec|test)_depend>($PIP_ONLY)</d" "$folder/contact_dynamics/package.xml"
echo "$folder/contact_dynamics"
echo "$folder/contact_dynamics_interfaces"
