; Helix reads `@indent` and `@outdent`, Zed `@indent` and `@end`, Neovim the names with a dot.
[(block) (scene_block) (shape_block) (layer_block)] @indent.begin
(block "}" @end @outdent @indent.branch) @indent
(scene_block "}" @end @outdent @indent.branch) @indent
(shape_block "}" @end @outdent @indent.branch) @indent
(layer_block "}" @end @outdent @indent.branch) @indent
