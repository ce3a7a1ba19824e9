#!/usr/bin/env bash
# include_rules.sh ROOT: who may include what. The rooms stand on each other in one direction only.
set -euo pipefail
cd "$1"

code=0
# forbid ROOMS PATTERN WHY
forbid() {
    local found
    # shellcheck disable=SC2086
    found=$(grep -rnE --include='*.hpp' --include='*.cpp' "^ *# *include *$2" $1 || true)
    [ -z "$found" ] || { printf '%s:\n%s\n' "$3" "$found" >&2; code=1; }
}
forbid "core" '<grapeshot/(adb|scf|narrowphase|plugin)' "core stands on no other room"
forbid "adb" '<grapeshot/(scf|narrowphase|plugin)' "adb stands on core alone"
forbid "scf" '<grapeshot/(adb|narrowphase|plugin)' "scf stands on core alone"
forbid "narrowphase" '<grapeshot/plugin' "narrowphase knows no engine"
forbid "core adb scf narrowphase" '[<"](bt[A-Z]|Bullet|LinearMath)' "Bullet belongs to plugin and above"
forbid "core adb scf narrowphase plugin demos" '[<"](tests|support|gtest|gmock|benchmark)/' "tests are seen by nobody"

# Public headers: the standard library, Eigen, ours; and the plugin's, Bullet.
public() { find "$1" -maxdepth 1 -name '*.hpp'; }
for header in $(public core) $(public adb) $(public scf) $(public narrowphase) $(public plugin); do
    allowed='<(grapeshot/[a-z_]+/[a-z_0-9]+\.hpp|Eigen/[A-Za-z]+|[a-z_]+)>'
    [[ $header != plugin/* ]] || allowed="($allowed|<(bt|LinearMath/|BulletCollision/|BulletDynamics/|BulletSoftBody/)[A-Za-z0-9/]*(\\.h)?>|<grapeshot/plugin\\.hpp>)"
    found=$(grep -nE '^ *# *include' "$header" | grep -vE "# *include $allowed" || true)
    [ -z "$found" ] || { printf '%s includes what a public header may not:\n%s\n' "$header" "$found" >&2; code=1; }
done
# A private header is included from its own room and from that room's tests; core's (the wide type and its kind) from
# the whole library without Bullet.
forbid "plugin demos" '<grapeshot/core/detail/' "core/detail belongs to the library without Bullet"
for room in adb scf narrowphase plugin; do
    others=$(find core adb scf narrowphase plugin demos -maxdepth 0 -not -name "$room" | tr '\n' ' ')
    forbid "$others" "<grapeshot/$room/detail/" "$room/detail belongs to $room"
done
exit $code
