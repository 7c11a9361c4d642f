import { expect, it } from "vitest";
import { coverageOf } from "../src/model/row";

it("tells what was seen of each blade, and nothing while that is not known", () => {
  expect(coverageOf({ status: "unknown", reason: "not_computed" })).toEqual([]);
  expect(coverageOf({ status: "estimated", coverage: [{ blade: 1, views_2: 0.56 }, { blade: "1-B2", views_2: 0 }, null, { blade: 3 }] })).toEqual([
    { blade: "1", seen: 0.56 },
    { blade: "1-B2", seen: 0 },
  ]);
});
