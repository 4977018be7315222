;;; bmod-mode.el --- models in bmod and GAMS  -*- lexical-binding: t -*-

;; Highlighting, and `bmod lsp' through eglot (in Emacs since 29): errors while typing, completion, hover, definitions,
;; renaming, layout.
;;
;;   (add-to-list 'load-path "…/editors/emacs")
;;   (require 'bmod-mode)
;;   (add-hook 'bmod-mode-hook #'eglot-ensure)

;;; Code:

(require 'bmod-words)

(defvar bmod-mode-syntax-table
  (let ((table (make-syntax-table)))
    (modify-syntax-entry ?' "\"" table)
    (modify-syntax-entry ?\" "\"" table)
    (modify-syntax-entry ?_ "w" table)
    table)
  "A quote of either kind holds a text.")

(defconst bmod-font-lock-keywords
  `(("^\\*.*$" 0 font-lock-comment-face t)
    ("//.*$" 0 font-lock-comment-face t)
    ("^[ \t]*\\$+[ \t]*[a-zA-Z]+" . font-lock-preprocessor-face)
    ("%[a-zA-Z_][a-zA-Z0-9_.]*%" . font-lock-variable-name-face)
    ("^[ \t]*\\([a-zA-Z][a-zA-Z0-9_]*\\)[^=;\n]*\\.\\." 1 font-lock-function-name-face)
    (,(regexp-opt bmod-declarations 'words) . font-lock-type-face)
    (,(regexp-opt bmod-statements 'words) . font-lock-keyword-face)
    (,(regexp-opt bmod-operators 'words) . font-lock-builtin-face)
    (,(concat (regexp-opt bmod-functions 'words) "[ \t]*[[({]") 1 font-lock-builtin-face)
    (,(regexp-opt bmod-constants 'words) . font-lock-constant-face))
  "What is coloured as what.")

;;;###autoload
(define-derived-mode bmod-mode prog-mode "bmod"
  "Models in bmod and GAMS."
  (setq-local comment-start "* "
              comment-start-skip "^\\*+[ \t]*"
              indent-tabs-mode nil
              tab-width 3
              font-lock-defaults '(bmod-font-lock-keywords nil t)))

;;;###autoload
(add-to-list 'auto-mode-alist '("\\.\\(blk\\|gms\\)\\'" . bmod-mode))

(with-eval-after-load 'eglot
  (defvar eglot-server-programs)
  (add-to-list 'eglot-server-programs '(bmod-mode . ("bmod" "lsp"))))

(provide 'bmod-mode)
;;; bmod-mode.el ends here
