import { expect, it } from "vitest";
import { bladesOf } from "../src/model/row";

it("tells what was seen of each blade by its name in the tables, and nothing while that is not known", () => {
  expect(bladesOf({ status: "unknown", reason: "not_computed" })).toEqual([]);
  expect(bladesOf({ status: "estimated", coverage: [{ blade: 1, name: "4", views_2: 0.56 }, { blade: 2, name: "1-B2", views_2: 0 }, { blade: 3, views_2: 1 }, null, { blade: 4 }] })).toEqual([
    { number: 1, name: "4", seen: 0.56 },
    { number: 2, name: "1-B2", seen: 0 },
    { number: 3, name: "3", seen: 1 },
  ]);
});
