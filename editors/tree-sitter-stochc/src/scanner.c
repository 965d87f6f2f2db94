// Reads the symbol of a unit, such as `mm` in `22 mm`. A unit is a whole word on the line of its number. `tick` before
// another number is not a unit: it begins the next clause of a scene. Also reads the `x` between two numbers of a plate.
#include "tree_sitter/parser.h"
#include <string.h>

enum { UNIT_SYMBOL, TIMES, ERROR_SENTINEL };

static const char *const BASES[] = {"ticks", "tick", "min", "rev", "rad", "rpm", "deg", "bar", "Pa", "Hz", "P", "m", "g",
                                    "s",     "h",    "N",   "J",   "W",   "L",   "K",   "A",   "T",  "V",  "%"};

// Symbols have at most five letters and a prefix.
#define LONGEST 6

static bool is_word(int32_t c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

static bool is_base(const char *symbol) {
    for (size_t i = 0; i < sizeof BASES / sizeof *BASES; i++) {
        if (strcmp(symbol, BASES[i]) == 0) return true;
    }
    return false;
}

void *tree_sitter_stochc_external_scanner_create(void) { return NULL; }
void tree_sitter_stochc_external_scanner_destroy(void *payload) { (void)payload; }
unsigned tree_sitter_stochc_external_scanner_serialize(void *payload, char *buffer) {
    (void)payload, (void)buffer;
    return 0;
}
void tree_sitter_stochc_external_scanner_deserialize(void *payload, const char *buffer, unsigned length) {
    (void)payload, (void)buffer, (void)length;
}

static bool is_blank(int32_t c) { return c == ' ' || c == '\t'; }

static bool is_space(int32_t c) { return is_blank(c) || c == '\r' || c == '\n'; }

static bool times(TSLexer *lexer) {
    while (is_space(lexer->lookahead)) lexer->advance(lexer, true);
    if (lexer->lookahead != 'x') return false;
    lexer->advance(lexer, false);
    lexer->result_symbol = TIMES;
    return !is_word(lexer->lookahead) || (lexer->lookahead >= '0' && lexer->lookahead <= '9');
}

bool tree_sitter_stochc_external_scanner_scan(void *payload, TSLexer *lexer, const bool *valid_symbols) {
    (void)payload;
    if (valid_symbols[ERROR_SENTINEL]) return false;
    if (valid_symbols[TIMES]) return times(lexer);
    if (!valid_symbols[UNIT_SYMBOL]) return false;
    while (is_blank(lexer->lookahead)) lexer->advance(lexer, true);

    char symbol[LONGEST + 1];
    size_t length = 0;
    // The micro sign and the Greek letter.
    if (lexer->lookahead == 0xb5 || lexer->lookahead == 0x3bc) {
        symbol[length++] = 'u';
        lexer->advance(lexer, false);
    }
    while (is_word(lexer->lookahead) || lexer->lookahead == '%') {
        if (length == LONGEST) return false;
        symbol[length++] = (char)lexer->lookahead;
        lexer->advance(lexer, false);
    }
    symbol[length] = 0;
    if (length == 0) return false;
    bool has_prefix = length > 1 && strchr("fpnumckMG", symbol[0]) != NULL && is_base(symbol + 1);
    if (!is_base(symbol) && !has_prefix) return false;
    lexer->mark_end(lexer);
    lexer->result_symbol = UNIT_SYMBOL;

    if (strcmp(symbol, "tick") != 0) return true;
    bool has_blank = false;
    while (is_space(lexer->lookahead)) {
        has_blank = true;
        lexer->advance(lexer, false);
    }
    return !(has_blank && lexer->lookahead >= '0' && lexer->lookahead <= '9');
}
