-- Parses and highlights the open program with the tree-sitter grammar.
local parser = vim.treesitter.get_parser(0, "stochc")
local root = parser:parse()[1]:root()
assert(not root:has_error(), "the tree has an error")
local get = vim.treesitter.query.get or vim.treesitter.query.get_query
local captures = 0
for _ in get("stochc", "highlights"):iter_captures(root, 0, 0, -1) do
    captures = captures + 1
end
assert(captures > 50, "captures: " .. captures)
for _, name in ipairs({ "folds", "indents", "locals" }) do
    assert(get("stochc", name), name)
end
local version = vim.version()
io.stdout:write(("Neovim %d.%d: %d captures\n"):format(version.major, version.minor, captures))
