-- Drives Neovim's own client of the protocol, and writes a line for everything that is as expected.
local log = assert(io.open(os.getenv("STOCHC_LOG"), "w"))

local function ok(what)
    log:write("ok " .. what .. "\n")
    log:flush()
end

local function expect(condition, why)
    if not condition then
        error(type(why) == "string" and why or vim.inspect(why))
    end
end

-- Waits until something has happened; the editor goes on with its work meanwhile.
local function await(condition, what)
    expect(vim.wait(60000, condition, 10), "waited in vain for " .. what)
end

local function run()
    local buffer = vim.api.nvim_get_current_buf()
    local id = vim.lsp.start_client({
        name = "stochc",
        cmd = { os.getenv("STOCHC"), "lsp" },
        root_dir = vim.fn.getcwd(),
    })
    vim.lsp.buf_attach_client(buffer, id)
    await(function()
        local client = vim.lsp.get_client_by_id(id)
        return client and client.initialized
    end, "the server")
    local client = vim.lsp.get_client_by_id(id)
    ok("attach")

    local function lines()
        return vim.api.nvim_buf_get_lines(buffer, 0, -1, false)
    end
    local function diagnostics()
        return vim.diagnostic.get(buffer)
    end
    -- The beginning of some words.
    local function place(words)
        for number, line in ipairs(lines()) do
            local column = line:find(words, 1, true)
            if column then
                vim.api.nvim_win_set_cursor(0, { number, column - 1 })
                return vim.lsp.util.make_position_params(0, client.offset_encoding)
            end
        end
        error("no " .. words)
    end
    local function ask(method, params)
        local answers = vim.lsp.buf_request_sync(buffer, "textDocument/" .. method, params, 60000)
        expect(answers and answers[id], method)
        return answers[id].result, answers[id].error or answers[id].err
    end

    -- What is typed is checked, saved or not: a block that nobody knows, and then all is well again.
    vim.api.nvim_buf_set_lines(buffer, 4, 5, false, { "        Q.up -> D" })
    await(function()
        return #diagnostics() > 0
    end, "diagnostics")
    local found = {}
    for _, diagnostic in ipairs(diagnostics()) do
        found[diagnostic.code or diagnostic.user_data.lsp.code] = diagnostic
    end
    expect(found["unknown-name"] and found["unknown-name"].lnum == 4, diagnostics())
    expect(found["unknown-name"].col == 8, found)
    ok("diagnostics")
    vim.api.nvim_buf_set_lines(buffer, 4, 5, false, { "        N.up  ->  D" })
    await(function()
        return #diagnostics() == 0
    end, "no diagnostics")
    ok("diagnostics as typed")

    local hover = ask("hover", place("C   //"))
    expect(hover.contents.value:find("(0, 0, 2), depth 2", 1, true), hover)
    ok("hover")

    local targets = ask("definition", place("B.up"))
    expect(#targets == 1 and targets[1].range.start.line == 3, targets)
    expect(targets[1].range.start.character == 16, targets)
    vim.lsp.util.jump_to_location(ask("definition", place("A.up"))[1], client.offset_encoding)
    local cursor = vim.api.nvim_win_get_cursor(0)
    expect(cursor[1] == 2 and cursor[2] == 23, cursor)
    ok("definition")

    local params = place("A.up")
    params.context = { includeDeclaration = true }
    expect(#ask("references", params) == 2, "references")
    ok("references")

    local symbols = ask("documentSymbol", { textDocument = params.textDocument })
    expect(symbols[1].name == "tower" and symbols[1].children[2].name == "grow", symbols)
    ok("symbols")

    params = place("B.up")
    params.newName = "Middle"
    vim.lsp.util.apply_workspace_edit(ask("rename", params), client.offset_encoding)
    expect(lines()[4] == "        A.up -> Middle.up -> C   // 🧱 is one character", lines())
    ok("rename")

    params = place("Middle")
    params.newName = "C"
    local result, refusal = ask("rename", params)
    expect(result == nil and refusal.message:find("already has a meaning", 1, true), refusal)
    ok("rename refused")

    local edits = ask("formatting", vim.lsp.util.make_formatting_params())
    expect(#edits == 1, edits)
    vim.lsp.util.apply_text_edits(edits, buffer, client.offset_encoding)
    expect(lines()[5] == "        N.up -> D", lines())
    ok("format")

    client.stop()
    await(function()
        return client.is_stopped()
    end, "the end")
    ok("shutdown")
end

local done, why = pcall(run)
if not done then
    log:write("failed: " .. tostring(why) .. "\n")
end
log:close()
vim.cmd(done and "qall!" or "cquit!")
