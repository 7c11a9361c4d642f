import { defineConfig } from "vite";

// The page of the study, built like that of a result and into a folder below it: one classic script can have one entry.
export default defineConfig({
  publicDir: "public-study",
  build: {
    outDir: "../core/viewer/bundle/study",
    emptyOutDir: true,
    target: "es2022",
    sourcemap: false,
    modulePreload: false,
    cssCodeSplit: false,
    reportCompressedSize: false,
    rollupOptions: {
      input: "src/study/main.tsx",
      output: { format: "iife", entryFileNames: "app.js", assetFileNames: "style.css" },
    },
  },
});
