/** The surface as the lens of a frame shows it, on a transparent canvas that lies over the unmodified picture. */

import { Mesh, PerspectiveCamera, Scene, Vector3, WebGLRenderer, WebGLRenderTarget } from "three";
import type { Layer } from "../model/hash";
import { norm, sub } from "../model/pose";
import type { Questions } from "./questions";
import { exposureOf, layerNumber, lensMaterial } from "./shading";
import type { Surface } from "./surface";

export class Overlay {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly material = lensMaterial();
  private readonly camera = new PerspectiveCamera();

  /** `size` is that of the source picture, px. Throws where the browser offers no WebGL 2. */
  constructor(
    canvas: HTMLCanvasElement,
    surface: Surface,
    private readonly questions: Questions,
    private readonly size: { readonly width: number; readonly height: number },
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    const mesh = new Mesh(surface.geometry, this.material);
    mesh.frustumCulled = false;
    this.scene.add(mesh);
    this.material.uniforms["exposure"]!.value = exposureOf(surface.mesh.color);
  }

  /** Draws the surface over a frame at a size in px; false when the frame has no camera. */
  draw(frame: number, width: number, height: number, looks: { readonly layer: Layer; readonly finding: number | null; readonly blade: number | null }): boolean {
    this.renderer.setSize(Math.round(width), Math.round(height), false);
    this.material.uniforms["layer"]!.value = layerNumber(looks.layer);
    this.material.uniforms["chosen"]!.value = looks.finding ?? -2;
    this.material.uniforms["alone"]!.value = looks.blade ?? 0;
    if (!this.aim(frame)) {
      this.renderer.clear();
      return false;
    }
    this.renderer.render(this.scene, this.camera);
    return true;
  }

  /** (height x width) 1 where the surface is drawn, row by row from above; for checks from outside. */
  silhouette(frame: number, width: number, height: number): Uint8Array {
    const target = new WebGLRenderTarget(width, height);
    const mask = new Uint8Array(width * height);
    if (this.aim(frame)) {
      this.renderer.setRenderTarget(target);
      this.renderer.clear();
      this.renderer.render(this.scene, this.camera);
      const pixels = new Uint8Array(4 * width * height);
      this.renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels);
      this.renderer.setRenderTarget(null);
      for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++) mask[y * width + x] = (pixels[4 * ((height - 1 - y) * width + x) + 3] as number) > 127 ? 1 : 0;
      }
    }
    target.dispose();
    return mask;
  }

  private aim(frame: number): boolean {
    const { lens, limit, surface } = this.questions;
    const pose = this.questions.poses.get(frame);
    if (!pose || !lens || !surface) return false;
    const uniforms = this.material.uniforms;
    for (let row = 0; row < 3; row++) uniforms["pose"]!.value[row].fromArray(pose.m as number[], 4 * row);
    uniforms["focus"]!.value.set(lens.fx, lens.fy, lens.cx, lens.cy);
    uniforms["radial"]!.value.set(...lens.radial);
    uniforms["tangential"]!.value = [...lens.tangential];
    uniforms["extent"]!.value = [this.size.width, this.size.height];
    const reach = norm(sub(pose.center, surface.center)) + 3 * surface.radius;
    uniforms["depths"]!.value = [0, reach];
    uniforms["fold"]!.value = Math.min(limit, 100);
    uniforms["fisheye"]!.value = lens.fisheye;
    (uniforms["eye"]!.value as Vector3).set(...pose.center);
    return true;
  }
}
