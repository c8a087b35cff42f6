# A scene leaves variants out; they are "not needed", forbidden ones stay forbidden.
. "$(dirname "$0")/common.inc"
small_project
cat >hall.yaml <<'YAML'
kiln_scene: 1
name: hall
objects:
  - {shader: paint, tint: red}
YAML
kiln count p/m.yaml --scene hall.yaml --json >c.json
expect_json c.json 'd["total"]["needed"]' 2
expect_json c.json 'd["total"]["legal"]' 5
expect_code 0 kiln explain p/m.yaml --scene hall.yaml tint=blue bright=true
expect_out "not needed by hall"
expect_code 0 kiln explain p/m.yaml --scene hall.yaml tint=none bright=true
expect_out forbidden
expect_out "nothing to brighten"
kiln build p/m.yaml -o a.kiln --scene hall.yaml --report-json r.json >/dev/null
expect_json r.json 'd["counts"]["needed"]' 2
expect_json r.json 'd["counts"]["classes"]' 2
expect_code 0 kiln explain a.kiln tint=blue bright=true
expect_out "not needed by hall"
expect_code 0 kiln explain a.kiln tint=none bright=true
expect_out forbidden
sed -i 's/tint: red/tint: none, bright: true/' hall.yaml
expect_code 1 kiln count p/m.yaml --scene hall.yaml
expect_err "hall.yaml:4"
