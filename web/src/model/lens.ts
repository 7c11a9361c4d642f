/**
 * The lens models of COLMAP: from the camera's frame to pixels and back. Pixel centres are at (0.5, 0.5).
 * A fisheye distorts the angle off the axis (Kannala and Brandt 2006, as in OpenCV), a perspective lens the tangent.
 */

export interface Lens {
  readonly fx: number;
  readonly fy: number;
  readonly cx: number;
  readonly cy: number;
  readonly radial: readonly [number, number, number, number];
  readonly tangential: readonly [number, number];
  readonly fisheye: boolean;
}

const PARAMETERS: Readonly<Record<string, readonly string[]>> = {
  SIMPLE_PINHOLE: ["f", "cx", "cy"],
  PINHOLE: ["fx", "fy", "cx", "cy"],
  SIMPLE_RADIAL: ["f", "cx", "cy", "k1"],
  RADIAL: ["f", "cx", "cy", "k1", "k2"],
  OPENCV: ["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"],
  SIMPLE_FISHEYE: ["f", "cx", "cy"],
  SIMPLE_RADIAL_FISHEYE: ["f", "cx", "cy", "k1"],
  RADIAL_FISHEYE: ["f", "cx", "cy", "k1", "k2"],
  OPENCV_FISHEYE: ["fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"],
};

/** The lens of a model from its parameters in COLMAP's order; null for a model that is not known. */
export function makeLens(model: string, params: readonly number[]): Lens | null {
  const names = PARAMETERS[model];
  if (!names || names.length !== params.length) return null;
  const at = (name: string): number => params[names.indexOf(name)] ?? 0;
  const focal = at("f");
  return {
    fx: at("fx") || focal,
    fy: at("fy") || focal,
    cx: at("cx"),
    cy: at("cy"),
    radial: [at("k1"), at("k2"), at("k3"), at("k4")],
    tangential: [at("p1"), at("p2")],
    fisheye: model.endsWith("FISHEYE"),
  };
}

/** Largest angle (fisheye) or tangent (perspective) before the radius stops growing; infinite when it never does. */
export function foldOf(lens: Lens): number {
  const [k1, k2, k3, k4] = lens.radial;
  const end = lens.fisheye ? Math.PI : 20;
  for (let value = 0; value <= end; value += end / 4000) {
    const s = value * value;
    if (1 + s * (3 * k1 + s * (5 * k2 + s * (7 * k3 + s * 9 * k4))) <= 0) return value;
  }
  return Infinity;
}

/** Pixel of a point in the camera's frame; null behind the camera or beyond the fold of the polynomial. */
export function project(lens: Lens, x: number, y: number, z: number, fold = foldOf(lens)): [number, number] | null {
  const [k1, k2, k3, k4] = lens.radial;
  const across = Math.hypot(x, y);
  if (z <= 0) return null;
  if (lens.fisheye) {
    const theta = Math.atan2(across, z);
    if (theta >= fold) return null;
    const s = theta * theta;
    const radius = theta * (1 + s * (k1 + s * (k2 + s * (k3 + s * k4))));
    const scale = across > 1e-12 ? radius / across : 1 / z;
    return [lens.fx * x * scale + lens.cx, lens.fy * y * scale + lens.cy];
  }
  const [u, v] = [x / z, y / z];
  const s = u * u + v * v;
  if (Math.sqrt(s) >= fold) return null;
  const [p1, p2] = lens.tangential;
  const radial = 1 + s * (k1 + s * k2);
  return [
    lens.fx * (u * radial + 2 * p1 * u * v + p2 * (s + 2 * u * u)) + lens.cx,
    lens.fy * (v * radial + 2 * p2 * u * v + p1 * (s + 2 * v * v)) + lens.cy,
  ];
}

/** Unit direction in the camera's frame that a pixel sees; null where the lens shows nothing. */
export function direction(lens: Lens, px: number, py: number): [number, number, number] | null {
  const mx = (px - lens.cx) / lens.fx;
  const my = (py - lens.cy) / lens.fy;
  if (lens.fisheye) {
    const radius = Math.hypot(mx, my);
    const theta = angleAt(lens, radius);
    if (theta === null) return null;
    if (radius < 1e-12) return [0, 0, 1];
    const sine = Math.sin(theta) / radius;
    return [mx * sine, my * sine, Math.cos(theta)];
  }
  return perspective(lens, mx, my);
}

/** Angle off the axis at a distorted radius, by Newton's method; null for none before the picture plane turns back. */
function angleAt(lens: Lens, radius: number): number | null {
  const [k1, k2, k3, k4] = lens.radial;
  let theta = Math.min(radius, 1.5);
  for (let step = 0; step < 50; step++) {
    const s = theta * theta;
    const error = theta * (1 + s * (k1 + s * (k2 + s * (k3 + s * k4)))) - radius;
    const slope = 1 + s * (3 * k1 + s * (5 * k2 + s * (7 * k3 + s * 9 * k4)));
    if (slope <= 0) return null;
    theta -= error / slope;
    if (Math.abs(error) < 1e-12) break;
  }
  return theta >= 0 && theta < Math.PI / 2 ? theta : null;
}

function perspective(lens: Lens, mx: number, my: number): [number, number, number] {
  const [k1, k2] = lens.radial;
  const [p1, p2] = lens.tangential;
  let [u, v] = [mx, my];
  for (let step = 0; step < 100; step++) {
    const s = u * u + v * v;
    const radial = 1 + s * (k1 + s * k2);
    const [before, beside] = [u, v];
    u = (mx - 2 * p1 * u * v - p2 * (s + 2 * u * u)) / radial;
    v = (my - 2 * p2 * before * v - p1 * (s + 2 * v * v)) / radial;
    if (Math.abs(u - before) + Math.abs(v - beside) < 1e-13) break;
  }
  const length = Math.hypot(u, v, 1);
  return [u / length, v / length, 1 / length];
}
