import { expect, test } from "vitest";
import { formatHash, NOWHERE, parseHash, type Place } from "../src/model/hash";

test("a state survives the address", () => {
  const place: Place = { tab: "frames", d: 3, f: 87, n: 12, p: [0.5, -1.25, 4], b: 2, layer: "support", cam: [1, 2, 3, 4, 5, 6, 0, -1, 0, 35] };
  expect(parseHash(formatHash(place))).toEqual(place);
  expect(parseHash(formatHash(NOWHERE))).toEqual(NOWHERE);
  expect(formatHash(NOWHERE)).toBe("#");
});

test("what is not understood is as if absent", () => {
  expect(parseHash("#d=<script>&f=-1&p=1,2&layer=evil&cam=1,2,NaN&tab=x&b=1e9")).toEqual(NOWHERE);
  expect(parseHash("#d=0").d).toBe(0);
});
