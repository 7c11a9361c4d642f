import { defineConfig } from "vite";

// One classic script and one style sheet, because modules and fetch are blocked where a page is opened from a folder.
export default defineConfig({
  build: {
    outDir: "../core/viewer/bundle",
    emptyOutDir: true,
    target: "es2022",
    sourcemap: false,
    modulePreload: false,
    cssCodeSplit: false,
    reportCompressedSize: false,
    rollupOptions: {
      input: "src/main.tsx",
      output: { format: "iife", entryFileNames: "app.js", assetFileNames: "style.css" },
    },
  },
  test: { include: ["test/**/*.test.ts"] },
} as Parameters<typeof defineConfig>[0]);
