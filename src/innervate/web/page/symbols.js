// Nodes by their shapes: square, diamond, triangle, disc; the monitor ringed, what is off crossed.
import { colours } from "./colours.js";
import { cross, stroke } from "./shapes.js";

/** Draw a node of a mesh or a station. */
export function symbol(context, x, y, dot, role, up) {
  const path = new Path2D();
  const corners = (points) => {
    points.forEach(([dx, dy], i) => path[i ? "lineTo" : "moveTo"](x + dx, y + dy));
    path.closePath();
  };
  if (role === "gateway") {
    const s = dot + 1.5;
    corners([[-s, -s], [s, -s], [s, s], [-s, s]]);
  } else if (role === "standby") {
    const s = dot + 3;
    corners([[0, -s], [s, 0], [0, s], [-s, 0]]);
  } else if (role === "robot") {
    const s = dot + 2.5;
    corners([[0, -s], [s, s], [-s, s]]);
  } else path.arc(x, y, dot, 0, 7);
  const dark = role === "gateway" || role === "standby" || role === "robot";
  context.fillStyle = up ? (dark ? colours.ink : colours.d[7]) : colours.faint;
  context.fill(path);
  stroke(context, up ? colours.ground : colours.soft, 1, path);
  if (role === "monitor") {
    const ring = new Path2D();
    ring.arc(x, y, dot + 4, 0, 7);
    stroke(context, colours.ink, 1.8, ring);
  }
  if (!up) {
    const off = new Path2D();
    cross(off, x, y, dot + 2);
    stroke(context, colours.alarm, 2.2, off);
  }
}
